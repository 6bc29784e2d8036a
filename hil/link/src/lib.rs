//! The simulated rig with its controller at the other end of a wire: the crate as a microcontroller's image, in an emulator.
//!
//! Results are those of the controller in this process, to the last bit. Building an image takes the compiler's target, and
//! running it takes the emulator; what is missing is said in one line with how to get it.
//!
//! | module | for |
//! |---|---|
//! | [`image`](mod@image) | images: built, and how large they are |
//! | [`lockstep`] | an image in the emulator, tick by tick with the simulated rig |
//! | [`own_timer`] | a board on its own timer: its telemetry recorded, and one emulated with a specimen beside it |
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
