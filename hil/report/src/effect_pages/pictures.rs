//! What the pictures of the effects show: the force of the mixed damping law alone and with an effect, by the crate's own effects in f64,
//! for a motion in which the effect shows.

use std::f64::consts::TAU;

use mesh_damper::effects::description::Description;
use mesh_damper::effects::{AugmentedLaw, CONTROLS, Effect, Motion};
use mesh_damper::law::Law;
use mesh_damper_model::Family;
use mesh_damper_reference::tables;

use crate::charts;
use crate::palette::Colour;
use crate::picture::{Axis, Dash, Layer, Look, Panel, Picture, Size, thinned};

/// Density in g/cm³ and amplitude in mm whose published coefficients the law has.
const SPECIMEN: (f64, f64) = (3.0, 0.1);
/// One panel.
const ONE: Size = ((560, 380), 15);
/// One of two panels side by side.
const BESIDE: Size = ((380, 310), 15);
/// Ticks of a cycle.
const TICKS: f64 = 2000.0;
/// Most points of all curves of a picture, whose bytes they nearly all are.
const POINTS: usize = 1080;
/// Most points of one.
const MOST_POINTS: usize = 320;
/// The law alone, and the curves beside it, each of which looks the same in all panels.
const LOOKS: [(Colour, Dash); 5] = [
    (Colour::Measured, Dash::Long),
    (Colour::After, Dash::Solid),
    (Colour::Before, Dash::Short),
    (Colour::Green, Dash::Mixed),
    (Colour::Pink, Dash::Dotted),
];
/// °C
const ROOM: f64 = 20.0;

/// An effect that is drawn: its name in the crate, and parameters element by element.
#[derive(Clone, Copy, PartialEq)]
pub struct Form {
    pub name: &'static str,
    pub parameters: &'static [f64],
}

/// A picture with the effects in it.
pub struct Drawn {
    pub picture: Picture,
    pub effects: Vec<(Form, &'static Description)>,
}

/// What a specimen goes through from rest.
#[derive(Clone)]
enum Course {
    /// Whole sines of these amplitudes in mm at a frequency in Hz, of which the last is drawn.
    Sines(Vec<f64>, f64),
    /// To 0.1 mm, a stay there, and back: all of it is drawn.
    Ramps,
}

/// A curve of a panel.
struct Curve {
    /// As the legend has it.
    name: String,
    /// The effect beside the law, or none.
    form: Option<Form>,
    course: Course,
    /// °C
    temperature: f64,
    /// The input.
    control: f64,
}

/// A panel: its title, whether it is over time, and its curves.
struct View(String, bool, Vec<Curve>);

impl Course {
    /// A steady sine.
    fn sine(amplitude: f64, frequency: f64) -> Self {
        Self::Sines(vec![amplitude; 3], frequency)
    }

    /// s
    fn tick(&self) -> f64 {
        match self {
            Self::Sines(_, frequency) => 1.0 / (frequency * TICKS),
            Self::Ramps => 5e-4,
        }
    }

    /// Displacement, velocity and acceleration at tick `n`, with cycles since the beginning.
    fn at(&self, n: usize) -> [f64; 4] {
        match self {
            Self::Sines(amplitudes, frequency) => {
                let cycles = n as f64 / TICKS;
                let amplitude = amplitudes.get(cycles as usize).or(amplitudes.last());
                let (sin, cos) = (TAU * (n % TICKS as usize) as f64 / TICKS).sin_cos();
                let omega = TAU * frequency;
                let scale = amplitude.copied().unwrap_or_default();
                let (y, v) = (scale * sin, scale * omega * cos);
                [y, v, -omega * omega * y, cycles]
            }
            Self::Ramps => match n as f64 * self.tick() {
                t if t < 0.1 => [t, 1.0, 0.0, 0.0],
                t if t < 0.4 => [0.1, 0.0, 0.0, 0.0],
                t if t < 0.5 => [0.5 - t, -1.0, 0.0, 0.0],
                _ => [0.0; 4],
            },
        }
    }

    /// The first tick that is drawn, and the last.
    fn drawn(&self) -> (usize, usize) {
        let cycle = TICKS as usize;
        match self {
            Self::Sines(amplitudes, _) => {
                ((amplitudes.len() - 1) * cycle, amplitudes.len() * cycle)
            }
            Self::Ramps => (0, 1600),
        }
    }
}

impl Curve {
    fn new(name: &str, form: Option<Form>, course: &Course) -> Self {
        Self {
            name: name.to_owned(),
            form,
            course: course.clone(),
            temperature: ROOM,
            control: 0.0,
        }
    }

    /// Time, displacement and force at every tick that is drawn.
    fn ticks(&self) -> Vec<[f64; 3]> {
        let (form, course) = (self.form, &self.course);
        let published = tables::interpolate(SPECIMEN.0, SPECIMEN.1);
        let law = Law::new(published.k1, published.k3, published.c, published.alpha);
        let mut law = AugmentedLaw::<f64, 1>::new(law.expect("a law"));
        if let Some(form) = form {
            let (number, tick) = (described(form).number, course.tick());
            let effect = Effect::from_parameters(number, form.parameters, tick);
            law = law.with(effect.expect("an effect")).expect("room for it");
        }
        let mut state = law.at_rest();
        let (first, last) = course.drawn();
        let ticks = (0..=last).map(|n| {
            let [displacement, velocity, acceleration, cycles] = course.at(n);
            let motion = Motion {
                displacement,
                velocity,
                acceleration,
                cycles,
                temperature: self.temperature,
                controls: [self.control; CONTROLS],
            };
            let time = n.saturating_sub(first) as f64 * course.tick();
            [time, displacement, law.force(&mut state, &motion)]
        });
        ticks.skip(first).collect()
    }
}

impl View {
    /// The law alone and with each of the effects under one motion.
    fn of(title: &str, over_time: bool, named: &[(&str, Form)], course: &Course) -> Self {
        let others = named.iter();
        let others = others.map(|(name, form)| Curve::new(name, Some(*form), course));
        Self::with(title, over_time, course, others.collect())
    }

    /// The law alone under a motion, and other curves.
    fn with(title: &str, over_time: bool, course: &Course, mut others: Vec<Curve>) -> Self {
        others.insert(0, Curve::new("law alone", None, course));
        Self(title.to_owned(), over_time, others)
    }

    /// With at most `points` points per curve; each curve looks as the place of its name in `names` says.
    fn panel(&self, points: usize, names: &[&str]) -> Panel {
        let Self(title, over_time, curves) = self;
        let layers = curves.iter().map(|curve| {
            let name = &curve.name[..];
            let place = names.iter().position(|other| *other == name);
            let (colour, dash) = LOOKS[place.expect("its name")];
            let ticks = curve.ticks();
            let points = thinned(0..ticks.len(), points).into_iter().map(|at| {
                let [time, displacement, force] = ticks[at];
                (if *over_time { time } else { displacement }, force)
            });
            Layer::new(name, colour, Look::Line(dash), points.collect())
        });
        let x = match over_time {
            true => Axis::new("time", "s"),
            false => charts::displacement(),
        };
        Panel {
            title: title.clone(),
            x,
            y: charts::force(),
            layers: layers.collect(),
        }
    }
}

fn described(form: Form) -> &'static Description {
    let effects = mesh_damper::effects::DESCRIPTIONS;
    let found = effects.iter().find(|effect| effect.name == form.name);
    found.expect("an effect of the crate")
}

/// One effect under sines of these amplitudes in mm and frequencies in Hz, each in a panel.
fn under(form: Form, sines: &[(f64, f64)]) -> Vec<View> {
    let named = [(&format!("with {}", form.name)[..], form)];
    let view = |&(amplitude, frequency): &(f64, f64)| {
        let title = format!("{amplitude} mm at {frequency} Hz");
        View::of(&title, false, &named, &Course::sine(amplitude, frequency))
    };
    sines.iter().map(view).collect()
}

/// The picture of a family: one of its own below, or its first effect, as it is typical, under a slow sine.
pub fn of(family: Family) -> Drawn {
    let form = |name, parameters| Form { name, parameters };
    let slow = Course::sine(0.1, 1.0);
    let views: Vec<View> = match family.name() {
        "asymmetry" => under(form("asymmetry", &[6.0]), &[(0.1, 1.0)]),
        "hardening" => under(form("hardening", &[400.0]), &[(0.2, 1.0)]),
        "load_friction" => under(form("load_friction", &[8.0]), &[(0.1, 1.0)]),
        "directional" => under(form("directional", &[0.5]), &[(0.1, 1.0)]),
        "stop" => under(form("stop", &[3.0, 0.05]), &[(0.1, 1.0)]),
        "viscous" => under(form("viscous", &[0.01]), &[(0.1, 1.0), (0.1, 10.0)]),
        "inertia" => under(form("inertia", &[200.0]), &[(0.1, 1.0), (0.1, 10.0)]),
        "backlash" => under(form("backlash", &[3.0, 0.02, 0.05]), &[(0.1, 1.0)]),
        "compliance" => under(form("compliance", &[4.0]), &[(0.1, 1.0)]),
        "yielding" => {
            let branch = form("yielding", &[2.0, 0.04, 0.6, 0.004]);
            under(branch, &[(0.1, 0.1), (0.1, 10.0)])
        }
        "gap" => {
            let forms = [
                ("damping inside too", form("gap", &[0.03, 1.0])),
                ("nothing inside", form("gap", &[0.03, 0.0])),
            ];
            vec![View::of("0.1 mm at 1 Hz", false, &forms, &slow)]
        }
        "stick_slip" => {
            const SEVERAL: [f64; 6] = [0.4, 0.02, 0.4, 0.04, 0.4, 0.06];
            let sharp = [
                ("one element", form("stick_slip", &[1.2, 0.04])),
                ("three", form("stick_slip", &SEVERAL)),
            ];
            let smooth = [
                ("giving way", form("bouc_wen", &[1.2, 0.04, 1.0])),
                (
                    "hardening",
                    form("hardening_friction", &[0.5, 0.3, 1.0, 4.0, 6.0]),
                ),
            ];
            vec![
                View::of("Sharp", false, &sharp, &slow),
                View::of("Smooth", false, &smooth, &slow),
            ]
        }
        "relaxation" => {
            let named = [("with relaxation", form("relaxation", &[1.6, 0.05]))];
            vec![
                View::of("0.1 mm at 3 Hz", false, &named, &Course::sine(0.1, 3.0)),
                View::of("Ramp and hold", true, &named, &Course::Ramps),
            ]
        }
        "control_input" => {
            let branch = form("control_input", &[2.0, 0.04, 0.3, 0.02, 0.0, 2.0, 0.0]);
            let under = |name: &str, control| Curve {
                control,
                ..Curve::new(name, Some(branch), &slow)
            };
            let inputs = vec![under("input of 0.5", 0.5), under("input of 2", 2.0)];
            vec![View::with("0.1 mm at 1 Hz", false, &slow, inputs)]
        }
        "degradation" => {
            let spring = form("degradation", &[4.0, 0.08, 0.3]);
            let slider = form("weakening", &[3.0, 0.03, 0.7, 0.2]);
            let after = |name: &str, form, amplitudes| {
                Curve::new(name, Some(form), &Course::Sines(amplitudes, 1.0))
            };
            let springs = vec![
                after("before 0.3 mm", spring, vec![0.1; 2]),
                after("after 0.3 mm", spring, vec![0.3, 0.1]),
            ];
            let sliders = vec![
                after("cycle 2", slider, vec![0.1; 2]),
                after("cycle 100", slider, vec![0.1; 100]),
            ];
            vec![
                View::with("Spring", false, &slow, springs),
                View::with("Slider", false, &slow, sliders),
            ]
        }
        "drift" => {
            let drift = form("drift", &[10.0, 0.6, 0.0, -0.5]);
            let cycles = [5, 40].map(|cycle| {
                let course = Course::Sines(vec![0.1; cycle], 1.0);
                Curve::new(&format!("cycle {cycle}"), Some(drift), &course)
            });
            vec![View::with("0.1 mm at 1 Hz", false, &slow, cycles.into())]
        }
        "temperature" => {
            let scaling = form("temperature", &[0.005, 20.0, 0.002]);
            let at = |name: &str, temperature| Curve {
                temperature,
                ..Curve::new(name, Some(scaling), &slow)
            };
            let degrees = vec![at("at −40 °C", -40.0), at("at 80 °C", 80.0)];
            vec![View::with("0.1 mm at 1 Hz", false, &slow, degrees)]
        }
        "periodic" => {
            let named = [("with periodic", form("periodic", &[0.02, 12.7, 0.0]))];
            vec![
                View::of("0.1 mm at 1 Hz", false, &named, &slow),
                View::of("The same over time", true, &named, &slow),
            ]
        }
        "delay" => {
            let forms = [
                ("late by 4 ms", form("delay", &[0.004])),
                ("low-pass of 56 Hz", form("force_filter", &[56.0])),
            ];
            [1.0, 10.0]
                .map(|frequency| {
                    let title = format!("0.1 mm at {frequency} Hz");
                    View::of(&title, false, &forms, &Course::sine(0.1, frequency))
                })
                .into()
        }
        _ => {
            let effect = family.first();
            under(form(effect.name, effect.typical), &[(0.1, 1.0)])
        }
    };
    let curves = || views.iter().flat_map(|view| &view.2);
    let mut effects: Vec<(Form, &'static Description)> = Vec::new();
    for form in curves().filter_map(|curve| curve.form) {
        if effects.iter().all(|(other, _)| *other != form) {
            effects.push((form, described(form)));
        }
    }
    let (columns, size) = match views.len() {
        1 => (1, ONE),
        _ => (2, BESIDE),
    };
    let title = format!("Force of the law alone and with {family}");
    let mut names: Vec<&str> = Vec::new();
    for curve in curves() {
        if !names.contains(&&curve.name[..]) {
            names.push(&curve.name);
        }
    }
    let points = (POINTS / curves().count()).min(MOST_POINTS);
    let panels = views.iter().map(|view| view.panel(points, &names));
    Drawn {
        picture: Picture::of_panels(title, size, columns, panels.collect()),
        effects,
    }
}
