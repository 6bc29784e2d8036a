//! The simulated rig with its controller at the other end of a wire: the crate as a microcontroller's image, in an emulator.
//!
//! Results equal those of the controller in this process, to the last bit. Building an image needs the compiler's target, and
//! running it needs the emulator. If one is missing, a one-line message says how to get it.
//!
//! | module | for |
//! |---|---|
//! | [`image`](mod@image) | images: building them, and their sizes |
//! | [`lockstep`] | an image in the emulator, tick by tick with the simulated rig |
//! | [`own_timer`] | a board on its own timer: recording its telemetry, and an emulated one with a simulated specimen |
//! | [`predict`](mod@predict) | the force that an image gives for a recorded motion |
//!
//! ```no_run
//! use mesh_damper_link::image::Board;
//! use mesh_damper_link::lockstep::Image;
//!
//! // Builds the firmware first, which may take a while.
//! let mut image = Image::start(Board::Mps2An386, Box::new(|line| println!("{}", line.text)))?;
//! println!("{:?}", image.statistics()?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

pub mod image;
pub mod lockstep;
pub mod own_timer;
pub mod predict;
