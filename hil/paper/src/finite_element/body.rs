//! A meshed body: its equations, and its equilibrium displacements.

use nalgebra::{SMatrix, Vector3, Vector6};

use super::FiniteElementError;
use super::contact::Mandrel;
use super::element::{Displacements, Element, NODES, POINTS, Relaxed, UNKNOWNS};
use super::equations::Pattern;
use super::material::MooneyRivlin;
use super::mesh::Mesh;
use super::relaxation::{History, Prony, Step};

/// Newton steps within which a body has to come to rest.
const MOST_STEPS: usize = 40;

/// Limit for the residual forces, relative to the acting ones.
const TOLERANCE: f64 = 1e-6;

/// A body of one material.
pub(super) struct Body {
    mesh: Mesh,
    elements: Vec<Element>,
    material: MooneyRivlin,
    mandrel: Option<Mandrel>,
    /// The equation of each degree of freedom, x, y, z of each node in turn; `None` where its displacement is prescribed.
    equations: Vec<Option<usize>>,
    pattern: Pattern,
    /// For each element and each entry of its tangent's lower triangle, row by row, the entry of the pattern.
    places: Vec<Vec<Option<usize>>>,
}

/// The history of a body whose shear relaxes: that of each point of each element.
#[derive(Clone)]
pub(super) struct Memory {
    pub prony: Prony,
    histories: Vec<[History; POINTS]>,
}

impl Memory {
    /// For a body that was never deformed.
    pub fn new(body: &Body, prony: Prony) -> Self {
        Self {
            prony,
            histories: vec![Default::default(); body.elements.len()],
        }
    }

    /// The state after infinitely many periods like the one of `period` s that led from `start` to here.
    pub fn repeat(&mut self, start: &Self, period: f64) {
        let both = self.histories.iter_mut().zip(&start.histories);
        for (end, start) in both.flat_map(|(end, start)| end.iter_mut().zip(start)) {
            end.repeat(start, &self.prony, period);
        }
    }
}

/// The equations at one state.
struct Assembled {
    /// Force on each degree of freedom, N, that keeps the body in its state, including the mandrel's push.
    force: Vec<f64>,
    /// Entries of the pattern.
    values: Vec<f64>,
    /// N, the largest force of an element.
    scale: f64,
}

impl Body {
    /// A body whose degrees of freedom in `prescribed` (3·node + axis) have given displacements.
    ///
    /// # Errors
    /// [`FiniteElementError::Inverted`] for a mesh with an element inside out, [`FiniteElementError::TooLarge`] for one too fine.
    pub fn new(
        mesh: Mesh,
        material: MooneyRivlin,
        mandrel: Option<Mandrel>,
        prescribed: impl IntoIterator<Item = usize>,
    ) -> Result<Self, FiniteElementError> {
        let mut held = vec![false; 3 * mesh.nodes.len()];
        prescribed
            .into_iter()
            .for_each(|unknown| held[unknown] = true);
        let mut count = 0;
        let equations: Vec<Option<usize>> = held
            .iter()
            .map(|held| {
                (!held).then(|| {
                    count += 1;
                    count - 1
                })
            })
            .collect();
        let elements = mesh
            .elements
            .iter()
            .map(|corners| Element::new(&corners.map(|node| mesh.nodes[node])))
            .collect::<Result<_, _>>()?;
        let of_element = |corners: &[usize; NODES]| -> Vec<Option<usize>> {
            corners
                .iter()
                .flat_map(|node| 3 * node..3 * node + 3)
                .map(|unknown| equations[unknown])
                .collect()
        };
        let groups = mesh
            .elements
            .iter()
            .map(|corners| of_element(corners).into_iter().flatten().collect());
        let pattern = Pattern::new(count, groups)?;
        let places = mesh
            .elements
            .iter()
            .map(|corners| {
                let equations = of_element(corners);
                let lower =
                    (0..UNKNOWNS).flat_map(|row| (0..=row).map(move |column| (row, column)));
                lower
                    .map(|(row, column)| {
                        let (row, column) = (equations[row]?, equations[column]?);
                        Some(pattern.entry(row.max(column), row.min(column)))
                    })
                    .collect()
            })
            .collect();
        Ok(Self {
            mesh,
            elements,
            material,
            mandrel,
            equations,
            pattern,
            places,
        })
    }

    /// Its mesh.
    #[cfg(test)]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Displacements of the undeformed body, mm, for each degree of freedom.
    pub fn undeformed(&self) -> Vec<f64> {
        vec![0.0; self.equations.len()]
    }

    /// The number of free displacements.
    pub fn unknowns(&self) -> usize {
        self.equations.iter().flatten().count()
    }

    /// Finds the equilibrium of the body by Newton's method, starting from `displacements` (mm, for each degree of freedom). The
    /// prescribed ones have their final values there, and the others are estimates. With a time step and its memory the shear
    /// relaxes; the memory is not changed.
    ///
    /// Returns the forces on every degree of freedom that hold it there, N.
    ///
    /// # Errors
    /// [`FiniteElementError::NotConverged`], [`FiniteElementError::Unstable`], [`FiniteElementError::Inverted`]; `displacements`
    /// are then those of the last attempt.
    pub fn rest(
        &self,
        displacements: &mut [f64],
        relaxing: Option<(&Memory, &Step)>,
    ) -> Result<Vec<f64>, FiniteElementError> {
        for _ in 0..MOST_STEPS {
            let Assembled {
                force,
                values,
                scale,
            } = self.assemble(displacements, relaxing)?;
            let mut step = vec![0.0; self.unknowns()];
            for (equation, force) in self.equations.iter().zip(&force) {
                if let Some(equation) = *equation {
                    step[equation] = -force;
                }
            }
            let left = step
                .iter()
                .fold(0.0_f64, |largest, force| largest.max(force.abs()));
            if left <= TOLERANCE * scale {
                return Ok(force);
            }
            self.pattern.solve(&values, &mut step)?;
            for (equation, displacement) in self.equations.iter().zip(displacements.iter_mut()) {
                *displacement += equation.map_or(0.0, |equation| step[equation]);
            }
        }
        Err(FiniteElementError::NotConverged)
    }

    /// Ends a time step at `displacements`.
    ///
    /// # Errors
    /// [`FiniteElementError::Inverted`].
    pub fn advance(
        &self,
        displacements: &[f64],
        memory: &mut Memory,
        step: &Step,
    ) -> Result<(), FiniteElementError> {
        for (index, histories) in memory.histories.iter_mut().enumerate() {
            let stresses =
                self.elements[index].stresses(&self.moved(index, displacements), &self.material)?;
            histories
                .iter_mut()
                .zip(stresses)
                .for_each(|(history, stress)| history.advance(step, stress));
        }
        Ok(())
    }

    /// The degrees of freedom that are prescribed.
    #[cfg(test)]
    pub fn prescribed(&self) -> impl Iterator<Item = usize> {
        (0..self.equations.len()).filter(|&unknown| self.equations[unknown].is_none())
    }

    /// Stored energy, N·mm, of a body without relaxation.
    #[cfg(test)]
    pub fn energy(&self, displacements: &[f64]) -> Result<f64, FiniteElementError> {
        (0..self.elements.len())
            .map(|index| {
                self.elements[index].energy(&self.moved(index, displacements), &self.material)
            })
            .sum()
    }

    fn moved(&self, element: usize, displacements: &[f64]) -> Displacements {
        let corners = &self.mesh.elements[element];
        SMatrix::from_fn(|axis, corner| displacements[3 * corners[corner] + axis])
    }

    fn assemble(
        &self,
        displacements: &[f64],
        relaxing: Option<(&Memory, &Step)>,
    ) -> Result<Assembled, FiniteElementError> {
        let mut force = vec![0.0; displacements.len()];
        let mut values = vec![0.0; self.pattern.entries()];
        let mut scale = 0.0_f64;
        for (index, element) in self.elements.iter().enumerate() {
            let moved = self.moved(index, displacements);
            let contribution = match relaxing {
                None => element.contribution(&moved, &self.material, Relaxed::NONE)?,
                Some((memory, step)) => {
                    let memory: [Vector6<f64>; POINTS] =
                        memory.histories[index].map(|history| history.memory(step));
                    let relaxed = Relaxed {
                        factor: step.factor(),
                        memory: &memory,
                    };
                    element.contribution(&moved, &self.material, relaxed)?
                }
            };
            scale = scale.max(contribution.force.amax());
            for (corner, node) in self.mesh.elements[index].iter().enumerate() {
                for axis in 0..3 {
                    force[3 * node + axis] += contribution.force[3 * corner + axis];
                }
            }
            let lower = (0..UNKNOWNS).flat_map(|row| (0..=row).map(move |column| (row, column)));
            for (entry, place) in lower.zip(&self.places[index]) {
                if let Some(place) = *place {
                    values[place] += contribution.tangent[entry];
                }
            }
        }
        if let Some(mandrel) = &self.mandrel {
            for &(node, area) in &mandrel.surface {
                let moved = Vector3::from_column_slice(&displacements[3 * node..3 * node + 3]);
                let Some(push) = mandrel.push(area, &(self.mesh.nodes[node] + moved)) else {
                    continue;
                };
                for (row, column) in [(0, 0), (1, 0), (1, 1)] {
                    if let (Some(i), Some(j)) = (
                        self.equations[3 * node + row],
                        self.equations[3 * node + column],
                    ) {
                        values[self.pattern.entry(i.max(j), i.min(j))] +=
                            push.tangent[(row, column)];
                    }
                }
                force[3 * node] += push.force.x;
                force[3 * node + 1] += push.force.y;
            }
        }
        Ok(Assembled {
            force,
            values,
            scale,
        })
    }
}
