//! The two forms in which a driver calls a part: blocking, and asynchronous.
//!
//! Code that exists in both is one text, in a macro that is called once for each form: its calls stand in `$wait!`, and its functions
//! begin with `$($async)?`.

/// The form of a blocking call: the call.
macro_rules! now {
    ($call:expr) => {
        $call
    };
}
pub(crate) use now;

/// The form of an asynchronous call: the call, awaited.
#[cfg(feature = "async")]
macro_rules! later {
    ($call:expr) => {
        $call.await
    };
}
#[cfg(feature = "async")]
pub(crate) use later;
