//! The ring of cameras.

use exhibits::scene::Ring;
use nalgebra::{Rotation3, Vector3};

#[test]
fn all_see_all_in_every_world_frame() {
    let ring = Ring::new(0.0);
    let turned = ring.in_world(&Rotation3::new(0.7 * Vector3::y()));
    assert_eq!(ring.factors.len(), 320);
    for ring in [ring, turned] {
        for factor in &ring.factors {
            let (pose, point) = (&ring.poses[factor.keyframe], &ring.points[factor.point]);
            let seen = ring.camera.project(pose, point).unwrap();
            assert!((seen - factor.pixel).norm() < 1e-9);
            assert!((0.0..640.0).contains(&seen.x) && (0.0..480.0).contains(&seen.y));
        }
    }
}
