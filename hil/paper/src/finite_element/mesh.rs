//! Structured meshes of hexahedra.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::element::NODES;

/// Nodes and the elements between them.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    /// Undeformed positions, mm.
    pub nodes: Vec<Vector3<f64>>,
    /// The corners of each element, in the order of [`super::element`].
    pub elements: Vec<[usize; NODES]>,
}

impl Mesh {
    /// The unit cube in `counts` elements along its axes, with each node moved by `place`, which must not mirror.
    pub fn of_cube(counts: [usize; 3], place: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Self {
        let [nx, ny, nz] = counts;
        let index = |i: usize, j: usize, k: usize| (i * (ny + 1) + j) * (nz + 1) + k;
        let share = |i: usize, count: usize| i as f64 / count as f64;
        let mut nodes = Vec::new();
        for i in 0..=nx {
            for j in 0..=ny {
                for k in 0..=nz {
                    nodes.push(place(Vector3::new(
                        share(i, nx),
                        share(j, ny),
                        share(k, nz),
                    )));
                }
            }
        }
        let mut elements = Vec::new();
        for i in 0..nx {
            for j in 0..ny {
                for k in 0..nz {
                    let face = |k| {
                        [
                            index(i, j, k),
                            index(i + 1, j, k),
                            index(i + 1, j + 1, k),
                            index(i, j + 1, k),
                        ]
                    };
                    let ([a, b, c, d], [e, f, g, h]) = (face(k), face(k + 1));
                    elements.push([a, b, c, d, e, f, g, h]);
                }
            }
        }
        Self { nodes, elements }
    }

    /// A quarter of a ring around z, mm: x ≥ 0, from +y around to −y, and 0 ≤ z ≤ `half_height`. `counts` elements around, along
    /// the radius and along z.
    pub fn of_ring(
        inner_radius: f64,
        outer_radius: f64,
        half_height: f64,
        counts: [usize; 3],
    ) -> Self {
        Self::of_cube(counts, |at| {
            // Starting from −y, so that the elements are not mirrored.
            let angle = PI * (at.x - 0.5);
            let radius = outer_radius + (inner_radius - outer_radius) * at.y;
            Vector3::new(
                radius * angle.cos(),
                radius * angle.sin(),
                half_height * at.z,
            )
        })
    }

    /// The nodes for which `is_there` holds.
    pub fn nodes_where<'a>(
        &'a self,
        is_there: impl Fn(&Vector3<f64>) -> bool + 'a,
    ) -> impl Iterator<Item = usize> + 'a {
        (0..self.nodes.len()).filter(move |&node| is_there(&self.nodes[node]))
    }

    /// The surface area at the nodes for which `is_there` holds, by node, mm²: a quarter of each face for each of its corners.
    pub fn areas(&self, is_there: impl Fn(&Vector3<f64>) -> bool) -> Vec<(usize, f64)> {
        const FACES: [[usize; 4]; 6] = [
            [0, 1, 2, 3],
            [4, 5, 6, 7],
            [0, 1, 5, 4],
            [1, 2, 6, 5],
            [2, 3, 7, 6],
            [3, 0, 4, 7],
        ];
        let mut areas = vec![0.0; self.nodes.len()];
        for element in &self.elements {
            for face in FACES.map(|face| face.map(|corner| element[corner])) {
                if face.iter().all(|&node| is_there(&self.nodes[node])) {
                    let [a, b, c, d] = face.map(|node| self.nodes[node]);
                    let area = 0.5 * (c - a).cross(&(d - b)).norm();
                    face.iter().for_each(|&node| areas[node] += 0.25 * area);
                }
            }
        }
        areas
            .into_iter()
            .enumerate()
            .filter(|(_, area)| *area > 0.0)
            .collect()
    }
}
