//! Times of one iteration on the scenes of the chapter.
//!
//! `cargo bench -p benches --bench bundle_adjustment`

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use vislam::bundle_adjustment::Solver;
use vislam::least_squares::Options;
use vislam::simulation::Scene;

fn iterations(criterion: &mut Criterion) {
    let scenes = [
        ("ring of 8 cameras and 40 points", Scene::ring(8, 40, 1.0, 1)),
        ("ring of 8 cameras and 4000 points", Scene::ring(8, 4000, 1.0, 1)),
        ("stereo ring of 8 rigs and 40 points", Scene::stereo_ring(8, 40, 0.1, 1.0, 1)),
        ("street of 100 cameras", Scene::street(100, 2.5, 1.0, 1)),
        ("street of 200 cameras", Scene::street(200, 2.5, 1.0, 1)),
    ];
    for (name, scene) in scenes {
        let options = Options::large_problem();
        criterion.bench_function(name, |bencher| {
            bencher.iter_batched_ref(
                || Solver::new(&scene.problem, &options).expect("a problem"),
                |solver| solver.iterate(),
                BatchSize::LargeInput,
            );
        });
    }
}

criterion_group!(benches, iterations);
criterion_main!(benches);
