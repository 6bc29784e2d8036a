//! The page's files, which are part of the program.

/// A file of the page.
pub(super) struct Asset {
    pub(super) path: &'static str,
    pub(super) kind: &'static str,
    pub(super) bytes: &'static [u8],
}

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const TEXT: &str = "text/plain; charset=utf-8";

macro_rules! assets {
    ($($path:literal: $kind:ident = $file:literal,)*) => {
        /// Every file that is served.
        pub(super) const ASSETS: &[Asset] = &[
            $(Asset {
                path: $path,
                kind: $kind,
                bytes: include_bytes!(concat!("../../page/", $file)),
            },)*
        ];
    };
}

assets! {
    "/": HTML = "index.html",
    "/style.css": CSS = "style.css",
    "/js/charts.js": SCRIPT = "js/charts.js",
    "/js/colours.js": SCRIPT = "js/colours.js",
    "/js/connection.js": SCRIPT = "js/connection.js",
    "/js/decimate.js": SCRIPT = "js/decimate.js",
    "/js/export.js": SCRIPT = "js/export.js",
    "/js/format.js": SCRIPT = "js/format.js",
    "/js/frames.js": SCRIPT = "js/frames.js",
    "/js/loop.js": SCRIPT = "js/loop.js",
    "/js/main.js": SCRIPT = "js/main.js",
    "/js/store.js": SCRIPT = "js/store.js",
    "/js/view.js": SCRIPT = "js/view.js",
    "/vendor/uplot/uPlot.iife.min.js": SCRIPT = "vendor/uplot/uPlot.iife.min.js",
    "/vendor/uplot/uPlot.min.css": CSS = "vendor/uplot/uPlot.min.css",
    "/vendor/uplot/LICENSE": TEXT = "vendor/uplot/LICENSE",
}
