//! The grid of a data set's chunks, and the place of each chunk in the data.

use hdf5_reader::error::Error;

/// The chunks of a data set in its dimensions.
pub(super) struct Grid<'d> {
    shape: &'d [u64],
    pub chunk: Vec<u32>,
    /// Bytes of a chunk.
    pub length: u64,
    /// Whether one chunk is the whole data set.
    pub is_one: bool,
    /// From this dimension on, bytes of a chunk that lie next to each other do so in the data set too.
    tail: usize,
}

impl<'d> Grid<'d> {
    /// That of data with elements of `size` bytes.
    pub fn of(shape: &'d [u64], size: usize, chunk: &[u32]) -> Result<Self, Error> {
        if chunk.len() != shape.len() || chunk.contains(&0) {
            return Err(Error::InvalidData(
                "chunks have other dimensions than their data".into(),
            ));
        }
        let length = (chunk.iter()).fold(size as u64, |all, &size| {
            all.saturating_mul(u64::from(size))
        });
        let is_whole = |place: usize| u64::from(chunk[place]) == shape[place];
        let rank = shape.len();
        let whole = (0..rank).rev().take_while(|&place| is_whole(place)).count();
        Ok(Self {
            shape,
            chunk: chunk.to_vec(),
            length,
            is_one: whole == rank,
            tail: (rank - whole).saturating_sub(1),
        })
    }

    /// Whether a chunk lies within the data set; one of a part that was cut off does not.
    pub fn has(&self, offsets: &[u64]) -> Result<bool, Error> {
        let is_on_grid = offsets.len() == self.shape.len()
            && (offsets.iter().zip(&self.chunk)).all(|(at, &size)| at % u64::from(size) == 0);
        if !is_on_grid {
            return Err(Error::InvalidData(
                "a chunk has a place between others".into(),
            ));
        }
        Ok(offsets.iter().zip(self.shape).all(|(at, size)| at < size))
    }

    /// The places of all chunks, the last dimension first.
    pub fn places(&self) -> impl Iterator<Item = Vec<u64>> {
        let mut next = (!self.shape.contains(&0)).then(|| vec![0; self.shape.len()]);
        std::iter::from_fn(move || {
            let place = next.take()?;
            let mut after = place.clone();
            for dimension in (0..after.len()).rev() {
                after[dimension] += u64::from(self.chunk[dimension]);
                if after[dimension] < self.shape[dimension] {
                    next = Some(after);
                    break;
                }
                after[dimension] = 0;
            }
            Some(place)
        })
    }

    /// Elements of a chunk within the data set in one dimension.
    fn room(&self, place: usize, offsets: &[u64]) -> u64 {
        (self.shape[place] - offsets[place]).min(u64::from(self.chunk[place]))
    }

    /// Steps of copying a chunk: the place of each run is computed in all dimensions outside of it.
    pub fn steps(&self, offsets: &[u64]) -> u64 {
        let rooms = (0..self.tail).map(|place| self.room(place, offsets));
        let runs = rooms.fold(1, u64::saturating_mul);
        runs.saturating_mul(2 + self.tail as u64)
            .saturating_add(self.length / 8)
    }

    /// Copies the part of a chunk that lies within the data set to its place.
    pub fn copy(&self, chunk: &[u8], offsets: &[u64], size: usize, all: &mut [u8]) {
        let rank = self.shape.len();
        let room = |place: usize| self.room(place, offsets) as usize;
        let inner = (self.tail + 1..rank).fold(size, |all, place| all * self.shape[place] as usize);
        let run = if rank == 0 {
            size
        } else {
            room(self.tail) * inner
        };
        let mut index = vec![0; self.tail];
        loop {
            let at = |sizes: &dyn Fn(usize) -> usize, from: &dyn Fn(usize) -> usize| -> usize {
                let outer = (0..self.tail).fold(0, |at, place| {
                    (at + from(place) + index[place]) * sizes(place + 1)
                });
                let last = if rank == 0 { 0 } else { from(self.tail) };
                (outer + last) * inner
            };
            let source = at(&|place| self.chunk[place] as usize, &|_| 0);
            let target = at(&|place| self.shape[place] as usize, &|place| {
                offsets[place] as usize
            });
            all[target..target + run].copy_from_slice(&chunk[source..source + run]);
            let carried = (0..self.tail).rev().find(|&place| {
                index[place] += 1;
                let is_over = index[place] == room(place);
                if is_over {
                    index[place] = 0;
                }
                !is_over
            });
            if carried.is_none() {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Chunks that are cut out of numbered elements give these again.
    #[test]
    fn chunks_are_copied_to_their_places() {
        for (shape, chunk) in [
            (&[7][..], &[3][..]),
            (&[4, 5], &[3, 2]),
            (&[4, 5], &[2, 5]),
            (&[4, 5], &[4, 5]),
            (&[3, 1, 4, 2], &[2, 1, 3, 2]),
            (&[2, 3], &[5, 9]),
        ] {
            let grid = Grid::of(shape, 2, chunk).unwrap();
            let count = shape.iter().product::<u64>() as usize;
            let mut all = vec![0; 2 * count];
            for place in grid.places() {
                assert!(grid.has(&place).unwrap());
                let mut bytes = Vec::new();
                for index in 0..grid.length as usize / 2 {
                    let (mut rest, mut at, mut step) = (index as u64, 0, 1);
                    for dimension in (0..shape.len()).rev() {
                        let size = u64::from(chunk[dimension]);
                        at += (place[dimension] + rest % size) * step;
                        step *= shape[dimension];
                        rest /= size;
                    }
                    bytes.extend([at as u8, 1]);
                }
                grid.copy(&bytes, &place, 2, &mut all);
            }
            let whole: Vec<u8> = (0..count).flat_map(|at| [at as u8, 1]).collect();
            assert_eq!(all, whole, "{shape:?} {chunk:?}");
        }
    }

    #[test]
    fn a_chunk_beside_the_data_is_left_out_and_one_between_others_is_refused() {
        let of = |chunk| Grid::of(&[4, 5], 1, chunk);
        let grid = of(&[3, 2]).unwrap();
        assert!(grid.has(&[3, 4]).unwrap());
        assert!(!grid.has(&[6, 0]).unwrap());
        assert!(grid.has(&[1, 0]).is_err());
        assert!(grid.has(&[0]).is_err());
        assert!(of(&[3]).is_err());
        assert!(of(&[3, 0]).is_err());
    }
}
