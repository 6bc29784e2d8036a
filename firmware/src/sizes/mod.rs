//! Small images, each with one use of the crate, to measure its flash, RAM and stack.
//!
//! An image sends lines of `name bytes` over the board's link with the stack that it used. Flash and RAM are read from its file. No
//! formatting is linked: it would be larger than the measured code.

mod call;
mod constructors;
mod damper;
mod one_effect;
mod running_law;
mod static_law;

use core::hint::black_box;

use mesh_damper::effects::Motion;

use crate::board::{Board, Link};
use crate::stack;

pub use constructors::constructors;
pub use damper::damper;
pub use one_effect::{one_effect_pack, one_effect_static};
pub use running_law::running_law;
pub use static_law::static_law;

/// Ticks of the motion for a use.
const TICKS: u16 = 300;

/// The mixed damping law of 1.2 kN/mm, 30 kN/mm³, 0.1 kN·(s/mm)^0.3 with stick-slip of 1.2 kN/mm and 0.03 mm, for 10 kHz, as
/// `hil export --format pack` writes it.
const PACK: &[u8] = include_bytes!("stick_slip.mdcp");

/// The motion of tick `n`: a triangle of 0.1 mm that the compiler cannot foresee.
fn motion(n: u16) -> Motion<f32> {
    let phase = f32::from(n % 100) * 0.02 - 1.0;
    Motion {
        displacement: black_box(0.1 * phase),
        velocity: black_box(2.0),
        ..Motion::default()
    }
}

/// Sends the number of bytes that `name` takes.
fn say(link: &mut impl Link, name: &str, bytes: u32) {
    let mut digits = [b'0'; 11];
    let mut rest = bytes;
    let mut first = digits.len() - 1;
    digits[first] = b'\n';
    loop {
        first -= 1;
        digits[first] = b'0' + (rest % 10) as u8;
        rest /= 10;
        if rest == 0 || first == 0 {
            break;
        }
    }
    link.send(name.as_bytes());
    link.send(b" ");
    link.send(digits.get(first..).unwrap_or_default());
}

/// Runs `work`, sends the stack of the whole image so far, and ends.
pub fn run<B: Board>(work: fn(&mut B::Link) -> Option<()>) -> ! {
    B::prepare();
    let mut link = B::Link::open();
    let done = work(&mut link);
    say(&mut link, "stack", stack::used());
    B::exit(done.is_some())
}

/// The image of one use on a board: its entry and its handlers.
#[macro_export]
macro_rules! size_image {
    ($board:ty, $use:ident) => {
        #[cortex_m_rt::entry]
        fn main() -> ! {
            $crate::sizes::run::<$board>($crate::sizes::$use::<$board>)
        }

        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo) -> ! {
            <$board as $crate::Board>::exit(false)
        }
    };
}
