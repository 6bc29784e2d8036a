//! A picture as SVG and in words.

use super::*;

fn layer(name: &str, look: Look) -> Layer {
    Layer::new(
        name,
        Colour::After,
        look,
        vec![(0.0, 0.0), (1.0, 2.0), (2.0, 1.0)],
    )
}

fn panel(layers: Vec<Layer>) -> Panel {
    Panel {
        title: "5 Hz & <more>".into(),
        x: Axis::new("displacement", "mm").over(0.0..2.0),
        y: Axis::new("force", "kN").over(0.0..2.0),
        layers,
    }
}

/// The value of the first attribute of this name.
fn attribute<'a>(svg: &'a str, name: &str) -> &'a str {
    let start = svg.find(&format!(" {name}=\"")).unwrap() + name.len() + 3;
    &svg[start..start + svg[start..].find('"').unwrap()]
}

#[test]
fn a_picture_says_what_it_is_and_where_its_values_lie() {
    let one = panel(vec![layer("measured", Look::Line(Dash::Solid))]);
    let picture = Picture::of("A loop", SMALL, one);
    let svg = picture.within_page();
    for said in [
        "role=\"img\"",
        "<title>A loop</title>",
        "<desc>5 Hz &amp; &lt;more&gt;: force over displacement. measured: 0 kN at 0 mm; 2.00 kN at 1.00 mm; 1.00 kN at 2.00 mm.</desc>",
        "data-x=\"displacement|mm|lin|0|2\"",
        "data-y=\"force|kN|lin|0|2\"",
        "data-curve=\"measured\"",
        ">displacement, mm</text>",
    ] {
        assert!(svg.contains(said), "{said}\n{svg}");
    }
    assert!(!svg.contains("<script"));
}

#[test]
fn points_lie_where_the_attributes_say() {
    let one = panel(vec![layer("a", Look::Both(Mark::Disc, Dash::Long))]);
    let svg = Picture::of("", SMALL, one).within_page();
    let at: Vec<f64> = attribute(&svg, "data-at")
        .split(' ')
        .map(|n| n.parse().unwrap())
        .collect();
    let (width, height) = (at[2], at[3]);
    // From the lower left corner to the top in the middle, and half way down at the right.
    let d = attribute(&svg[svg.find("data-curve").unwrap()..], "d");
    let (w, h) = ((20.0 * width).round(), (20.0 * height).round());
    let start = format!("M0,{h}l{}-{h}", (10.0 * width).round());
    assert!(d.starts_with(&start), "{d} {start}");
    assert!(svg.contains(&format!("viewBox=\"0 0 {w} {h}\"")));
    assert_eq!(svg.matches("<circle").count(), 3);
    assert!(svg.contains("stroke-dasharray"));
}

#[test]
fn every_panel_and_every_layer_is_drawn() {
    let looks = [
        Look::Line(Dash::Dotted),
        Look::Fine,
        Look::Broad,
        Look::Cloud(Dot::Square),
        Look::Stems,
    ];
    let layers = looks.into_iter().map(|look| layer("x", look)).collect();
    let panels = vec![panel(layers); 4];
    let picture = Picture::of_panels("Four", SMALL, 3, panels);
    assert_eq!(picture.size, (1140, 600));
    let svg = picture.within_page();
    assert_eq!(svg.matches("class=\"panel\"").count(), 4);
    assert_eq!(svg.matches("data-curve").count(), 4 * 5);
    let marks = [
        Mark::Disc,
        Mark::Ring,
        Mark::Square,
        Mark::Diamond,
        Mark::Triangle,
        Mark::Cross,
    ];
    let marks = marks.map(|mark| layer("x", Look::Marks(mark)));
    let svg = Picture::of("", SMALL, panel(marks.into())).within_page();
    assert_eq!(svg.matches("transform=\"translate(").count(), 6 * 3 + 1);
}

#[test]
fn a_file_of_its_own_has_its_legend_and_its_dark_colours() {
    let layers = ["measured", "the law & more"].map(|name| layer(name, Look::Broad));
    let picture = Picture::of("", STANDALONE, panel(layers.into()));
    let svg = picture.alone();
    assert!(svg.starts_with("<svg xmlns="));
    assert!(svg.contains("prefers-color-scheme:dark"));
    assert!(svg.contains(">the law &amp; more</text>"));
    assert_eq!(picture.named().len(), 2);
    // A key in the page has the same names.
    let key = key([&picture], &[("measured", "what was measured".into())]).into_string();
    assert!(key.contains("data-curve=\"the law &amp; more\""));
    assert!(key.contains("what was measured"));
}

#[test]
fn a_gap_is_a_gap_and_a_map_has_no_cell_where_nothing_is() {
    let mut gap = layer("a", Look::Fine);
    gap.points[1] = (f64::NAN, f64::NAN);
    let svg = Picture::of("", SMALL, panel(vec![gap])).within_page();
    let d = attribute(&svg[svg.find("data-curve").unwrap()..], "d");
    assert_eq!(d.matches(['M', 'm']).count(), 2, "{d}");
    let map = Layer::new(
        "",
        Colour::Ink,
        Look::Cells(Cells {
            values: vec![-0.2, f64::NAN, 0.0, 0.1],
            columns: 2,
            scale: 0.2,
            unit: "kN",
        }),
        vec![(0.0, 0.0), (2.0, 2.0)],
    );
    let picture = Picture::of("", SMALL, panel(vec![map]));
    let svg = picture.within_page();
    assert!(svg.contains("data-cells=\"-1000,,0,500\""));
    assert_eq!(svg.matches("z\"/>").count(), 3);
    assert!(
        picture.in_words().contains("3 cells"),
        "{}",
        picture.in_words()
    );
    assert!(
        Picture::of("", SMALL, panel(Vec::new()))
            .alone()
            .starts_with("<svg")
    );
}
