//! The colours of pages and pictures, on light paper and on dark.
//!
//! A picture carries the light colours as attributes, which every program for SVG understands. On a dark screen, [`rules`] replace
//! them by the dark ones; print stays light.

use std::fmt::Write as _;

/// A colour by its meaning. The hues of the curves are those of Okabe and Ito (2008), which remain distinct to the colour-blind.
/// They are darkened or lightened to at least 3 : 1 against the paper, the contrast that WCAG 2.2 requires for graphics (1.4.11).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Colour {
    /// The page, and the ground of a picture.
    Paper,
    /// Letters and axes.
    Ink,
    /// Letters of less weight.
    Faint,
    /// Lines of a grid, and edges.
    Grid,
    /// Measurements.
    Measured,
    /// The law alone; failures.
    Before,
    /// The law with the effects found; links.
    After,
    /// Letters of failures.
    Fails,
    /// A third curve.
    Green,
    /// A fourth curve.
    Pink,
    /// A fifth curve.
    Yellow,
    /// A sixth curve.
    Sky,
}

use Colour::{After, Before, Fails, Faint, Green, Grid, Ink, Measured, Paper, Pink, Sky, Yellow};

impl Colour {
    /// Every colour.
    pub const ALL: [Self; 12] = [
        Paper, Ink, Faint, Grid, Measured, Before, After, Fails, Green, Pink, Yellow, Sky,
    ];

    /// Its name as a variable of a style sheet.
    pub const fn name(self) -> &'static str {
        match self {
            Paper => "paper",
            Ink => "ink",
            Faint => "faint",
            Grid => "grid",
            Measured => "measured",
            Before => "before",
            After => "after",
            Fails => "fails",
            Green => "green",
            Pink => "pink",
            Yellow => "yellow",
            Sky => "sky",
        }
    }

    /// On light paper.
    pub const fn light(self) -> &'static str {
        match self {
            Paper => "#ffffff",
            Ink => "#222222",
            Faint => "#555555",
            Grid => "#e4e4e4",
            Measured => "#8c8c8c",
            Before => "#d55e00",
            After => "#0072b2",
            Fails => "#a04600",
            Green => "#008f68",
            Pink => "#b8578f",
            Yellow => "#a87400",
            Sky => "#2b86c0",
        }
    }

    /// On dark paper.
    pub const fn dark(self) -> &'static str {
        match self {
            Paper => "#15181c",
            Ink => "#e6e8ea",
            Faint => "#a9afb6",
            Grid => "#343a41",
            Measured => "#8b929a",
            Before => "#ff8d45",
            After => "#56b4f2",
            Fails => "#ffa066",
            Green => "#35c796",
            Pink => "#e79ac6",
            Yellow => "#efb83f",
            Sky => "#a5d8ff",
        }
    }
}

/// Steps of a map's colours on each side of zero.
const STEPS: i32 = 10;

/// The colour of `part`, from −1 (blue) to 1 (red), on light paper or on dark. At 0 it is that of the paper, so that only nonzero
/// values stand out. Its ends are ColorBrewer's RdBu, which the colour-blind can distinguish.
pub fn shade(part: f64, dark: bool) -> String {
    shade_of(
        (part.clamp(-1.0, 1.0) * f64::from(STEPS)).round() as i32,
        dark,
    )
}

fn shade_of(step: i32, dark: bool) -> String {
    let (none, blue, red) = match dark {
        false => ([247.0; 3], [33.0, 102.0, 172.0], [178.0, 24.0, 43.0]),
        true => (
            [38.0, 42.0, 48.0],
            [92.0, 172.0, 250.0],
            [250.0, 110.0, 96.0],
        ),
    };
    let end: [f64; 3] = if step > 0 { red } else { blue };
    let part = f64::from(step.abs()) / f64::from(STEPS);
    let mixed = |i: usize| none[i] + (end[i] - none[i]) * part;
    let [r, g, b] = [0, 1, 2].map(|i| mixed(i).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The style sheet's variables.
pub fn variables() -> String {
    let all = |of: fn(Colour) -> &'static str| {
        Colour::ALL.iter().fold(String::new(), |mut all, colour| {
            let _ = write!(all, "--{}:{};", colour.name(), of(*colour));
            all
        })
    };
    format!(
        ":root{{color-scheme:light;{}}}\n@media screen and (prefers-color-scheme:dark){{:root{{color-scheme:dark;{}}}}}\n",
        all(Colour::light),
        all(Colour::dark)
    )
}

/// Rules that make a picture dark on a dark screen.
pub fn rules() -> String {
    let colours = Colour::ALL.map(|colour| (colour.light().to_owned(), colour.dark().to_owned()));
    let shades = (-STEPS..=STEPS).map(|step| (shade_of(step, false), shade_of(step, true)));
    let mut all = format!(
        "@media screen and (prefers-color-scheme:dark){{svg.picture{{fill:{}}}",
        Ink.dark()
    );
    for (light, dark) in colours.into_iter().chain(shades) {
        let _ = write!(
            all,
            ".picture [fill=\"{light}\"]{{fill:{dark}}}.picture [stroke=\"{light}\"]{{stroke:{dark}}}"
        );
    }
    all.push('}');
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance as WCAG 2.2 defines it.
    fn luminance(colour: &str) -> f64 {
        let channel = |at: usize| {
            let value = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap()) / 255.0;
            if value <= 0.04045 {
                value / 12.92
            } else {
                ((value + 0.055) / 1.055).powf(2.4)
            }
        };
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    }

    fn contrast(a: &str, b: &str) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn contrast_is_that_of_wcag() {
        assert!((contrast("#000000", "#ffffff") - 21.0).abs() < 1e-9);
        assert!((contrast("#777777", "#ffffff") - 4.48).abs() < 0.01);
    }

    #[test]
    fn letters_and_curves_stand_out_from_the_paper_in_both_themes() {
        for of in [Colour::light, Colour::dark] {
            for colour in [Ink, Faint, After, Fails] {
                let found = contrast(of(colour), of(Paper));
                assert!(found >= 4.5, "{colour:?} {}: {found:.2}", of(colour));
            }
            for colour in [Measured, Before, After, Green, Pink, Yellow, Sky] {
                let found = contrast(of(colour), of(Paper));
                assert!(found >= 3.0, "{colour:?} {}: {found:.2}", of(colour));
            }
        }
    }

    #[test]
    fn colours_are_distinct_in_both_themes() {
        for of in [Colour::light, Colour::dark] {
            let mut all: Vec<String> = Colour::ALL.map(|colour| of(colour).into()).into();
            all.extend((-STEPS..=STEPS).map(|step| shade_of(step, of(Paper) == Paper.dark())));
            let count = all.len();
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), count);
        }
    }

    #[test]
    fn a_map_is_pale_where_there_is_nothing_and_full_at_its_ends() {
        assert_eq!(shade(0.04, false), "#f7f7f7");
        assert_eq!(shade(7.0, false), "#b2182b");
        assert_eq!(shade(-1.0, false), "#2166ac");
        for dark in [false, true] {
            let ends = [-1.0, 1.0].map(|part| contrast(&shade(part, dark), &shade(0.0, dark)));
            assert!(ends.iter().all(|&found| found >= 3.0), "{ends:?}");
        }
    }
}
