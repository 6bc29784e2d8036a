//! Saved states of an instance, by their numbers.

use super::Instance;
use crate::refusal::Refusal;
use crate::state::State;

impl Instance {
    /// `fmi2GetFMUstate`: its number, or that of `over` if it is replaced.
    ///
    /// # Errors
    /// `over` is not a saved state.
    pub fn save(&mut self, over: usize) -> Result<usize, Refusal> {
        if over != 0 {
            *self.saved_mut(over)? = self.state.clone();
            return Ok(over);
        }
        Ok(self.keep(self.state.clone()))
    }

    fn keep(&mut self, state: State) -> usize {
        let number = self.next_saved;
        self.next_saved += 1;
        self.saved.insert(number, Box::new(state));
        number
    }

    fn unknown_state(number: usize) -> Refusal {
        Refusal::new(
            "FMUstate",
            number,
            "no state that this instance saved, or one that was freed",
            "give one of fmi2GetFMUstate or fmi2DeSerializeFMUstate",
        )
    }

    fn saved_mut(&mut self, number: usize) -> Result<&mut State, Refusal> {
        match self.saved.get_mut(&number) {
            Some(state) => Ok(state),
            None => Err(Self::unknown_state(number)),
        }
    }

    /// `fmi2SetFMUstate`
    ///
    /// # Errors
    /// Not a saved state.
    pub fn restore(&mut self, number: usize) -> Result<(), Refusal> {
        self.state = self.saved_mut(number)?.clone();
        Ok(())
    }

    /// `fmi2FreeFMUstate`
    ///
    /// # Errors
    /// Not a saved state.
    pub fn free_saved(&mut self, number: usize) -> Result<(), Refusal> {
        let removed = self.saved.remove(&number);
        removed.map(drop).ok_or_else(|| Self::unknown_state(number))
    }

    /// The bytes of a saved state.
    ///
    /// # Errors
    /// Not a saved state.
    pub fn serialized(&mut self, number: usize) -> Result<Vec<u8>, Refusal> {
        let state = self.saved_mut(number)?.clone();
        state.to_bytes(&self.contents.guid)
    }

    /// Stores a state from these bytes, and returns its number.
    ///
    /// # Errors
    /// As [`State::from_bytes`].
    pub fn deserialize(&mut self, bytes: &[u8]) -> Result<usize, Refusal> {
        let state = State::from_bytes(bytes, &self.contents.guid)?;
        Ok(self.keep(state))
    }
}
