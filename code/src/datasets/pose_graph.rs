//! Files of pose graphs, as g2o, TORO and the collections made for them have them.
//!
//! A line begins with a tag. In space: `VERTEX_SE3:QUAT id x y z qx qy qz qw` and `EDGE_SE3:QUAT id id`
//! with the same seven numbers, or `VERTEX3 id x y z roll pitch yaw` and `EDGE3 id id` with these six. In
//! the plane: `VERTEX_SE2` or `VERTEX2` with `id x y θ`, and `EDGE_SE2` or `EDGE2`. An edge says where the
//! second vertex stands in the frame of the first one: `first_from_second`. The upper triangle of its
//! information follows, or nothing, which stands for the identity.
//!
//! # Orders
//!
//! Row by row, translation first, as in a twist of [`se3`](crate::manifold::se3), in all of these but
//! `EDGE2`: TORO's own six numbers are I₁₁ I₁₂ I₂₂ I₃₃ I₁₃ I₂₃. Other programs read these files
//! otherwise:
//!
//! - g2o measures a rotation in space by the vector part of its quaternion, half the rotation vector,
//!   so the information about an axis is a quarter of what is written. GTSAM takes what is written for
//!   that of a rotation vector, and so does this reader.
//! - GTSAM 4.3 has rotations first in memory and exchanges the blocks of `EDGE_SE3:QUAT`; those of
//!   `EDGE3` it takes as they stand, so that what is written for the translation weighs the rotation.
//!
//! Whether the error is the logarithm of Z⁻¹ T₁⁻¹ T₂, as here and in GTSAM, or its translation beside its
//! angle, as in g2o, makes no difference where it is zero and little where it is small.

use std::collections::BTreeMap;
use std::str::{FromStr, SplitWhitespace};

use nalgebra::{Isometry2, Isometry3, Quaternion, SMatrix, Translation3, UnitQuaternion, Vector2};
use thiserror::Error;

use super::table::{rotation, shortened};
use crate::factors::GraphPose;
use crate::loop_closure::{LoopClosureError, PoseGraph, RelativeMeasurement};

/// A pose graph as a file has it.
#[derive(Debug, Clone)]
pub struct PoseGraphFile<P: GraphPose<D>, const D: usize> {
    /// The graph, its poses in the order of the vertices' names. A file without any vertex has those
    /// that follow from chained measurements.
    pub graph: PoseGraph<P, D>,
    /// The names of the poses.
    pub vertices: Vec<u64>,
    /// How many lines say something that is not a part of a pose graph: `FIX`, `EQUIV`, `PARAMS_…`
    /// and comments.
    pub left_out: usize,
}

// ANCHOR: read_pose_graph
/// The pose graph in space in the text of a file.
///
/// # Errors
///
/// [`PoseGraphError`] tells a line that is not as it should be.
pub fn read_pose_graph(text: &str) -> Result<PoseGraphFile<Isometry3<f64>, 6>, PoseGraphError> {
    read(text, |fields| match fields.tag {
        "VERTEX_SE3:QUAT" => fields.vertex(Fields::quaternion_pose),
        "VERTEX3" => fields.vertex(Fields::euler_pose),
        "EDGE_SE3:QUAT" => fields.edge(Fields::quaternion_pose, Fields::upper_triangle),
        "EDGE3" => fields.edge(Fields::euler_pose, Fields::upper_triangle),
        _ => fields.other(),
    })
}

/// The pose graph in the plane in the text of a file.
///
/// # Errors
///
/// [`PoseGraphError`] tells a line that is not as it should be.
pub fn read_planar_graph(text: &str) -> Result<PoseGraphFile<Isometry2<f64>, 3>, PoseGraphError> {
    read(text, |fields| match fields.tag {
        "VERTEX_SE2" | "VERTEX2" => fields.vertex(Fields::planar_pose),
        "EDGE_SE2" => fields.edge(Fields::planar_pose, Fields::upper_triangle),
        "EDGE2" => fields.edge(Fields::planar_pose, Fields::toro_triangle),
        _ => fields.other(),
    })
}
// ANCHOR_END: read_pose_graph

/// What a line says.
enum Entry<P: GraphPose<D>, const D: usize> {
    Vertex { name: u64, pose: P },
    Edge { names: [u64; 2], measured: P::Measured, information: SMatrix<f64, D, D> },
    LeftOut,
}

/// An edge, and where it stands.
struct Edge<P: GraphPose<D>, const D: usize> {
    line: usize,
    names: [u64; 2],
    measured: P::Measured,
    information: SMatrix<f64, D, D>,
}

// ANCHOR: read_lines
fn read<P: GraphPose<D> + Default, const D: usize>(
    text: &str,
    parse: impl Fn(&mut Fields) -> Result<Entry<P, D>, PoseGraphFault>,
) -> Result<PoseGraphFile<P, D>, PoseGraphError> {
    let mut vertices: BTreeMap<u64, P> = BTreeMap::new();
    let (mut edges, mut left_out, mut end) = (Vec::new(), 0, 1);
    for (line, text) in (1..).zip(text.trim_start_matches('\u{feff}').lines()) {
        let at = |fault| PoseGraphError { line, fault };
        let mut fields = text.split_whitespace();
        let Some(tag) = fields.next() else { continue };
        let mut fields = Fields { tag, fields };
        match parse(&mut fields).map_err(at)? {
            Entry::LeftOut => left_out += 1,
            Entry::Vertex { name, pose } => {
                fields.end().map_err(at)?;
                if vertices.insert(name, pose).is_some() {
                    return Err(at(PoseGraphFault::Twice { vertex: name }));
                }
            }
            Entry::Edge { names, measured, information } => {
                fields.end().map_err(at)?;
                edges.push(Edge { line, names, measured, information });
            }
        }
        end = line;
    }
    assemble(vertices, edges, left_out, end)
}
// ANCHOR_END: read_lines

// ANCHOR: assemble_graph
/// The graph of vertices and edges, which name vertices.
fn assemble<P: GraphPose<D> + Default, const D: usize>(
    mut vertices: BTreeMap<u64, P>,
    edges: Vec<Edge<P, D>>,
    left_out: usize,
    end: usize,
) -> Result<PoseGraphFile<P, D>, PoseGraphError> {
    let has_vertices = !vertices.is_empty();
    for Edge { line, names, .. } in &edges {
        for name in names {
            if has_vertices && !vertices.contains_key(name) {
                let fault = PoseGraphFault::NoVertex { vertex: *name };
                return Err(PoseGraphError { line: *line, fault });
            }
            vertices.entry(*name).or_default();
        }
    }
    let (names, poses): (Vec<u64>, Vec<P>) = vertices.into_iter().unzip();
    let lines: Vec<usize> = edges.iter().map(|edge| edge.line).collect();
    let number = |name: u64| names.partition_point(|other| *other < name);
    let measurement = |edge: Edge<P, D>| RelativeMeasurement {
        first: number(edge.names[0]),
        second: number(edge.names[1]),
        measured: edge.measured,
        information: edge.information,
    };
    let mut graph = PoseGraph { poses, measurements: edges.into_iter().map(measurement).collect() };
    let chained = graph.chained().map_err(|error| fault_of(error, &lines, &names, end))?;
    if !has_vertices {
        graph.poses = chained;
    }
    Ok(PoseGraphFile { graph, vertices: names, left_out })
}
// ANCHOR_END: assemble_graph

/// What is wrong with a graph, in the words of its file.
fn fault_of(error: LoopClosureError, lines: &[usize], names: &[u64], end: usize) -> PoseGraphError {
    use LoopClosureError::{Empty, Information, SamePose, Unreached};
    let (line, fault) = match error {
        Empty { .. } => (end, PoseGraphFault::NoEdge),
        Unreached { pose } => {
            let [first, vertex] = [names[0], names[pose]];
            (end, PoseGraphFault::Unreached { first, vertex })
        }
        SamePose { measurement, pose } => {
            (lines[measurement], PoseGraphFault::SameVertex { vertex: names[pose] })
        }
        Information { measurement } => (lines[measurement], PoseGraphFault::Information),
        other => (end, PoseGraphFault::Graph(other)),
    };
    PoseGraphError { line, fault }
}

/// The fields of a line behind its tag.
struct Fields<'a> {
    tag: &'a str,
    fields: SplitWhitespace<'a>,
}

impl Fields<'_> {
    fn vertex<P: GraphPose<D>, const D: usize>(
        &mut self,
        pose: impl Fn(&mut Self) -> Result<P, PoseGraphFault>,
    ) -> Result<Entry<P, D>, PoseGraphFault> {
        Ok(Entry::Vertex { name: self.name()?, pose: pose(self)? })
    }

    fn edge<P: GraphPose<D>, const D: usize>(
        &mut self,
        measured: impl Fn(&mut Self) -> Result<P::Measured, PoseGraphFault>,
        information: impl Fn(&mut Self) -> Result<SMatrix<f64, D, D>, PoseGraphFault>,
    ) -> Result<Entry<P, D>, PoseGraphFault> {
        let names = [self.name()?, self.name()?];
        let measured = measured(self)?;
        let ends_here = self.fields.clone().next().is_none();
        let information = if ends_here { SMatrix::identity() } else { information(self)? };
        Ok(Entry::Edge { names, measured, information })
    }

    /// A line that is neither vertex nor edge.
    fn other<P: GraphPose<D>, const D: usize>(&mut self) -> Result<Entry<P, D>, PoseGraphFault> {
        let is_known = ["FIX", "EQUIV"].contains(&self.tag)
            || self.tag.starts_with("PARAMS_")
            || self.tag.starts_with('#');
        let tag = || PoseGraphFault::Tag { tag: shortened(self.tag) };
        is_known.then_some(Entry::LeftOut).ok_or_else(tag)
    }

    fn next<T: FromStr>(&mut self, wanted: &'static str) -> Result<T, PoseGraphFault> {
        let text = self.fields.next().ok_or(PoseGraphFault::Short { wanted })?;
        text.parse().map_err(|_| PoseGraphFault::Number { text: shortened(text), wanted })
    }

    fn name(&mut self) -> Result<u64, PoseGraphFault> {
        self.next("the number of a vertex")
    }

    // ANCHOR: graph_fields
    fn numbers<const N: usize>(
        &mut self,
        wanted: &'static str,
    ) -> Result<[f64; N], PoseGraphFault> {
        let mut numbers = [0.0_f64; N];
        for number in &mut numbers {
            *number = self.next(wanted)?;
            if !number.is_finite() {
                return Err(PoseGraphFault::Number { text: number.to_string(), wanted });
            }
        }
        Ok(numbers)
    }

    fn quaternion_pose(&mut self) -> Result<Isometry3<f64>, PoseGraphFault> {
        let [x, y, z, qx, qy, qz, qw] =
            self.numbers("a finite number of a position or quaternion")?;
        let quaternion = Quaternion::new(qw, qx, qy, qz);
        let norm = quaternion.norm();
        let rotation = rotation(quaternion).map_err(|_| PoseGraphFault::Quaternion { norm })?;
        Ok(Isometry3::from_parts(Translation3::new(x, y, z), rotation))
    }

    // ANCHOR_END: graph_fields

    /// Turned by the roll about x, then the pitch about y, then the yaw about z, all axes fixed.
    fn euler_pose(&mut self) -> Result<Isometry3<f64>, PoseGraphFault> {
        let [x, y, z, roll, pitch, yaw] = self.numbers("a finite number of a position or angle")?;
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        Ok(Isometry3::from_parts(Translation3::new(x, y, z), rotation))
    }

    fn planar_pose(&mut self) -> Result<Isometry2<f64>, PoseGraphFault> {
        let [x, y, angle] = self.numbers("a finite number of a position or angle")?;
        Ok(Isometry2::new(Vector2::new(x, y), angle))
    }

    /// Row by row.
    fn upper_triangle<const D: usize>(&mut self) -> Result<SMatrix<f64, D, D>, PoseGraphFault> {
        let mut information = SMatrix::zeros();
        for (row, column) in (0..D).flat_map(|row| (row..D).map(move |column| (row, column))) {
            let [number] = self.numbers("a finite number of the information")?;
            (information[(row, column)], information[(column, row)]) = (number, number);
        }
        Ok(information)
    }

    /// In TORO's order.
    fn toro_triangle(&mut self) -> Result<SMatrix<f64, 3, 3>, PoseGraphFault> {
        let [xx, xy, yy, tt, xt, yt] = self.numbers("a finite number of the information")?;
        Ok(SMatrix::<f64, 3, 3>::new(xx, xy, xt, xy, yy, yt, xt, yt, tt))
    }

    fn end(&mut self) -> Result<(), PoseGraphFault> {
        match self.fields.next() {
            Some(text) => Err(PoseGraphFault::Rest { text: shortened(text) }),
            None => Ok(()),
        }
    }
}

/// What is wrong with the file of a pose graph, and in which line, counted from one. Whoever opened
/// the file adds its name in front.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("line {line}: {fault}")]
pub struct PoseGraphError {
    /// Where.
    pub line: usize,
    /// What.
    pub fault: PoseGraphFault,
}

/// What can be wrong with a line of such a file.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PoseGraphFault {
    /// A line begins with something else.
    #[error(
        "`{tag}` is neither vertex nor edge of a pose graph of this kind; read planar graphs as such, \
         and remove landmarks"
    )]
    Tag {
        /// The beginning of the tag.
        tag: String,
    },
    /// A line has too few fields.
    #[error("the line ends where {wanted} should stand; it is not complete")]
    Short {
        /// What is missing.
        wanted: &'static str,
    },
    /// A line has too many fields.
    #[error("`{text}` stands behind the last number of the line; remove it")]
    Rest {
        /// The beginning of the field.
        text: String,
    },
    /// A field is no number, or none that is allowed.
    #[error("`{text}` is not {wanted}; mend the field or remove the line")]
    Number {
        /// The beginning of the field.
        text: String,
        /// What it should be.
        wanted: &'static str,
    },
    /// An orientation is none.
    #[error("the quaternion has norm {norm}; a rotation has norm 1, with its scalar part last")]
    Quaternion {
        /// Its norm.
        norm: f64,
    },
    /// The information is none.
    #[error(
        "the information matrix is not positive definite; look at the order of its numbers, which in \
         EDGE2 is I11 I12 I22 I33 I13 I23, and in EDGE_SE2 and all others row by row"
    )]
    Information,
    /// A vertex stands twice.
    #[error("vertex {vertex} stands here for the second time; remove one of the two")]
    Twice {
        /// The vertex.
        vertex: u64,
    },
    /// An edge names a vertex that has no line.
    #[error("vertex {vertex} has no line of its own; add one, or remove those of all others")]
    NoVertex {
        /// The vertex.
        vertex: u64,
    },
    /// An edge names one vertex twice.
    #[error("the edge goes from vertex {vertex} to itself; remove it")]
    SameVertex {
        /// The vertex.
        vertex: u64,
    },
    /// There are no measurements.
    #[error("the file ends without any edge; it is not complete")]
    NoEdge,
    /// The graph falls apart.
    #[error(
        "no chain of edges leads from vertex {first} to vertex {vertex}; add one, or split the file"
    )]
    Unreached {
        /// The first vertex.
        first: u64,
        /// One that is not reached.
        vertex: u64,
    },
    /// Whatever else keeps it from being a graph.
    #[error(transparent)]
    Graph(LoopClosureError),
}
