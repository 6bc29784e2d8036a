//! Code generated from the list of effects, in which each effect has one line outside its own file.
//!
//! Forces are added in the order of the list, the light ones first, the rare ones last. A motion passes through the stages in that
//! order too.

/// Generates the module of each effect in the list, [`Effect`](super::Effect) over all of them, and the sets of effects and of
/// their states that an [`AugmentedLaw`](super::AugmentedLaw) holds.
macro_rules! effects {
    ($($module:ident: $name:ident,)+) => {
        $(
            pub mod $module;
            pub use $module::$name;
        )+

        /// Descriptions of all effects, in the order in which their forces are added.
        pub const DESCRIPTIONS: &[Description] = &[
            $(<$name<f32> as Equations<f32>>::DESCRIPTION,)+
        ];

        /// Configuration of any one effect.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum Effect<R> {
            $(#[doc = concat!("See [`", stringify!($name), "`].")] $name($name<R>),)+
        }

        impl<R: Real> Effect<R> {
            /// The effect with the pack number `number`. `parameters` are in the order of its description, element by element; a
            /// tick lasts `tick` s.
            ///
            /// # Errors
            /// A number that no effect has, or the error of the effect's constructor.
            pub fn from_parameters(
                number: u8,
                parameters: &[f64],
                tick: f64,
            ) -> Result<Self, ConfigError> {
                $(if number == <$name<R> as Equations<R>>::DESCRIPTION.number {
                    return $name::from_parameters(parameters, tick).map(Self::$name);
                })+
                Err(unknown(number))
            }

            /// Its description.
            pub fn description(&self) -> Description {
                match self {
                    $(Self::$name(_) => <$name<R> as Equations<R>>::DESCRIPTION,)+
                }
            }

            /// Bytes that it takes of a law whose type names it: its configuration and its state.
            pub fn bytes(&self) -> usize {
                match self {
                    $(Self::$name(_) => {
                        size_of::<$name<R>>() + size_of::<<$name<R> as Equations<R>>::State>()
                    })+
                }
            }

            /// Its bit, and the field that holds it.
            fn place(&self) -> (u32, &'static str) {
                match self {
                    $(Self::$name(_) => (Bit::$name.mask(), stringify!($module)),)+
                }
            }
        }

        impl Effect<f32> {
            /// Writes its number, its number of words, and the words.
            pub(crate) fn pack(&self, writer: &mut Writer<'_>) {
                let mut words = heapless::Vec::<f32, MOST_WORDS>::new();
                // Takes as many words as fit.
                let mut put = |word| {
                    let _ = words.push(word);
                };
                let number = match self {
                    $(Self::$name(effect) => {
                        effect.pack(&mut put);
                        <$name<f32> as Equations<f32>>::DESCRIPTION.number
                    })+
                };
                // A length below 128 takes one byte.
                writer.bytes(&[number, words.len() as u8]);
                for word in &words {
                    writer.f32(*word);
                }
            }

            /// The effect from its `number` and the words that [`Effect::pack`] wrote; the words are not checked yet. `None` if
            /// they cannot be those of an effect.
            pub(crate) fn unpack(number: u8, words: &[f32]) -> Option<Self> {
                $(if number == <$name<f32> as Equations<f32>>::DESCRIPTION.number {
                    return $name::unpack(words).map(Self::$name);
                })+
                None
            }

            /// Whether an effect has this number in a pack.
            pub(crate) fn is_known(number: u8) -> bool {
                $(number == <$name<f32> as Equations<f32>>::DESCRIPTION.number)||+
            }
        }

        /// One bit per effect.
        #[derive(Clone, Copy)]
        enum Bit {
            $($name,)+
            ResidualTable,
        }

        impl Bit {
            const fn mask(self) -> u32 {
                1 << self as u32
            }
        }

        /// The bit of the residual table, which does not count as an effect.
        const CORRECTION: u32 = Bit::ResidualTable.mask();
        /// The bit of a law that is being written; no effect has it.
        const UNFINISHED: u32 = 1 << 31;
        const _: () = assert!(CORRECTION < UNFINISHED);
        const LIGHT: u32 = $(if is_cost(&<$name<f32> as Equations<f32>>::DESCRIPTION, Cost::Light) { Bit::$name.mask() } else { 0 })|+;
        const RARE: u32 = $(if is_cost(&<$name<f32> as Equations<f32>>::DESCRIPTION, Cost::Rare) { Bit::$name.mask() } else { 0 })|+;
        const SCALING: u32 = $(if <$name<f32> as Equations<f32>>::DESCRIPTION.scales_law { Bit::$name.mask() } else { 0 })|+;
        const STAGES: u32 = $(if is_kind(&<$name<f32> as Equations<f32>>::DESCRIPTION, EffectKind::Stage) { Bit::$name.mask() } else { 0 })|+;

        /// Up to one effect of each kind.
        #[derive(Clone, Debug, PartialEq)]
        struct Effects<R> {
            /// The bits of the effects that are present, and of the residual table.
            present: u32,
            $($module: $name<R>,)+
        }

        /// State of the effects of an [`AugmentedLaw`]: empty before the first tick.
        #[derive(Clone, Debug)]
        // The longest state comes at the end of the list, so that the others are within the offset of a load.
        #[repr(C)]
        // A simulation that goes back in time writes it and reads it again.
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(
            feature = "serde",
            serde(bound(
                serialize = "R: serde::Serialize",
                deserialize = "R: serde::Deserialize<'de>"
            ))
        )]
        pub struct AugmentedState<R: Real> {
            $($module: <$name<R> as Equations<R>>::State,)+
            correction: ResidualTableState,
        }

        impl<R: Real> AugmentedState<R> {
            /// State before the first tick, for any effects. All bits are 0.
            pub(crate) const AT_REST: Self = Self {
                $($module: <$name<R> as Equations<R>>::AT_REST,)+
                correction: ResidualTableState::NEW,
            };
        }

        impl<R: Real> Effects<R> {
            /// All bits are 0.
            const NONE: Self = Self {
                present: 0,
                $($module: <$name<R> as Equations<R>>::NONE,)+
            };

            fn add(&mut self, effect: Effect<R>) -> Result<(), ConfigError> {
                let (bit, field) = effect.place();
                if self.present & bit != 0 {
                    return Err(ConfigError::Full { field, capacity: 1 });
                }
                self.present |= bit;
                match effect {
                    $(Effect::$name(effect) => self.$module = effect,)+
                }
                Ok(())
            }

            /// [`Equations::check`] of the effect with this number, and, for a known tick, [`Equations::check_tick`].
            #[inline(never)]
            fn check(&self, number: u8, tick: Option<R>) -> Result<(), ConfigError> {
                $(if number == <$name<R> as Equations<R>>::DESCRIPTION.number {
                    self.$module.check()?;
                    return tick.map_or(Ok(()), |tick| self.$module.check_tick(tick));
                })+
                Ok(())
            }

            /// The first effect for which [`Equations::supplies`] names a parameter.
            #[inline(never)]
            fn supplies(&self) -> Option<Active> {
                $(if self.has(Bit::$name.mask())
                    && let Some((field, value)) = self.$module.supplies()
                {
                    return Some(Active {
                        effect: <$name<R> as Equations<R>>::DESCRIPTION.name,
                        field,
                        value: value.to_f64(),
                    });
                })+
                None
            }

            /// [`AugmentedLaw::least_damping`]
            #[inline(never)]
            fn least_damping(&self) -> (R, Active) {
                let mut left = R::ONE;
                let mut by = Active { effect: "", field: "", value: 0.0 };
                $(if matches!(<$name<R> as Equations<R>>::DESCRIPTION.energy, Energy::ScalesDamping)
                    && self.has(Bit::$name.mask())
                {
                    let (field, value, change) = self.$module.least_damping();
                    left += change;
                    if change < R::ZERO {
                        by = Active {
                            effect: <$name<R> as Equations<R>>::DESCRIPTION.name,
                            field,
                            value: value.to_f64(),
                        };
                    }
                })+
                (left, by)
            }

            /// The bits of the effects.
            fn kinds(&self) -> u32 {
                self.present & !(CORRECTION | UNFINISHED)
            }

            #[inline(always)]
            fn has(&self, bit: u32) -> bool {
                self.present & bit != 0
            }

            fn iter(&self) -> impl Iterator<Item = Effect<R>> {
                [$(self.has(Bit::$name.mask()).then_some(Effect::$name(self.$module)),)+]
                    .into_iter()
                    .flatten()
            }

            /// Sum of `law` and of every force but those of the rare effects, kN.
            #[inline(always)]
            fn add_force(
                &self,
                state: &mut AugmentedState<R>,
                motion: &ClampedMotion<R>,
                law: LawForce<R>,
            ) -> R {
                let mut total = law.total;
                if self.present & LIGHT != 0 {
                    $(if LIGHT & Bit::$name.mask() != 0 {
                        total += self.$module.force(&mut state.$module, motion, law);
                    })+
                }
                $(if (LIGHT | RARE) & Bit::$name.mask() == 0 && self.has(Bit::$name.mask()) {
                    total += self.$module.force(&mut state.$module, motion, law);
                })+
                total
            }

            /// Sum of `force` and of the rare effects' forces, kN.
            #[inline(always)]
            fn add_rare_force(
                &self,
                state: &mut AugmentedState<R>,
                motion: &ClampedMotion<R>,
                law: LawForce<R>,
                force: R,
            ) -> R {
                let mut total = force;
                if self.present & RARE & !STAGES != 0 {
                    $(if RARE & !STAGES & Bit::$name.mask() != 0 && self.has(Bit::$name.mask()) {
                        total += self.$module.force(&mut state.$module, motion, law);
                    })+
                }
                total
            }

            /// The forces of `law` alone, as the effects scale them, kN.
            // Not inlined, because it is called twice, and not on every tick.
            #[inline(never)]
            fn scaled(&self, motion: &ClampedMotion<R>, law: LawForce<R>) -> R {
                let mut total = law.total;
                $(if SCALING & Bit::$name.mask() != 0 && self.has(Bit::$name.mask()) {
                    total += self.$module.force_of_law(motion, law);
                })+
                total
            }

            /// [`AugmentedLaw::force_through_stages`] without the residual table.
            #[inline(always)]
            fn force_through_stages(
                &self,
                state: &mut AugmentedState<R>,
                motion: &ClampedMotion<R>,
                law: &Law<R>,
                damping: impl Fn(R) -> R,
            ) -> R {
                let mut motion = *motion;
                $(if STAGES & Bit::$name.mask() != 0 && self.has(Bit::$name.mask()) {
                    motion = self.$module.felt(&motion);
                })+
                let viscous = self.viscous.viscous();
                let mut solved = None;
                $(if STAGES & Bit::$name.mask() != 0 && self.has(Bit::$name.mask())
                    && let Some((seen, force)) =
                        self.$module.solved(&mut state.$module, &motion, law, viscous, &damping)
                {
                    motion = seen;
                    solved = Some(force);
                })+
                let law = match solved {
                    Some(law) => law,
                    None => LawForce::of(law, &motion, damping),
                };
                let force = self.add_force(state, &motion, law);
                let force = self.add_rare_force(state, &motion, law, force);
                let mut added = force - law.total;
                $(if self.has(Bit::$name.mask()) {
                    added -= self.$module.outside(&motion);
                })+
                let mut shown = force;
                $(if STAGES & Bit::$name.mask() != 0 && self.has(Bit::$name.mask()) {
                    self.$module.added(&mut state.$module, added, viscous);
                    shown = self.$module.shown(&mut state.$module, shown);
                })+
                shown
            }
        }
    };
}
