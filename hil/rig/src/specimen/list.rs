//! A list of effects makes the enumeration, and what follows from the name, the sizes and the units of each.

/// Each effect has its name, its sizes with their units, and after a semicolon what is no size. A force is proportional to the sizes
/// that are `scaled`. The variant after the last semicolon has effects of another list.
macro_rules! effects {
    (
        $(#[$attribute:meta])*
        enum $effects:ident {
            $(
                $(#[$doc:meta])*
                $variant:ident = $name:literal {
                    $($(#[$size_doc:meta])* $size:ident: $unit:literal $($scaled:ident)?,)*
                    $(; $($(#[$other_doc:meta])* $other:ident: $type:ty,)*)?
                }
            )*
            $(; $(#[$inner_doc:meta])* $inner:ident($inner_type:ty))?
        }
    ) => {
        $(#[$attribute])*
        pub enum $effects {
            $(
                $(#[$doc])*
                $variant {
                    $($(#[$size_doc])* $size: f64,)*
                    $($($(#[$other_doc])* $other: $type,)*)?
                },
            )*
            $($(#[$inner_doc])* $inner($inner_type),)?
        }

        impl $effects {
            /// The families of all of them, each once, but for those of another list.
            pub const FAMILIES: &[&str] = &[$($name),*];

            /// The family under which a trace names it, or the kind of an unlisted one.
            pub fn family(&self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => $name,)*
                    $(Self::$inner(effect) => effect.family(),)?
                }
            }

            /// The same effect with `factor` times the force; a gap, a delay or a compliance with `factor` times the width, delay or
            /// compliance.
            pub fn scaled(mut self, factor: f64) -> Self {
                match &mut self {
                    $(Self::$variant { $($size,)* .. } => {
                        $(if crate::specimen::list::is_marked(&[$(stringify!($scaled))?]) {
                            *$size *= factor;
                        })*
                    })*
                    $(Self::$inner(effect) => *effect = effect.scaled(factor),)?
                }
                self
            }

            /// Its sizes as (name, value, unit).
            pub(super) fn sizes(&self) -> Vec<(&'static str, f64, &'static str)> {
                match *self {
                    $(Self::$variant { $($size,)* .. } => vec![$((stringify!($size), $size, $unit)),*],)*
                    $(Self::$inner(effect) => effect.sizes(),)?
                }
            }
        }
    };
}

pub(super) use effects;

/// Whether a size has a mark in the list.
pub(super) fn is_marked(marks: &[&str]) -> bool {
    marks == ["scaled"]
}
