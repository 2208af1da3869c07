//! Memory that is kept from frame to frame: fetching fresh pages costs as much as a sixth of an estimation.

use std::{
    cell::RefCell,
    ops::{Deref, DerefMut},
    thread::LocalKey,
};

use crate::components::Run;

/// So many vectors of one kind are kept by each thread at most.
const MOST: usize = 24;
/// Longer ones are given back at once, bytes: pictures of ordinary size need far less.
const LONGEST: usize = 64 << 20;

/// Vectors that nobody uses now.
type Shelf<T> = RefCell<Vec<Vec<T>>>;

/// What vectors of it are kept.
pub trait Keep: Sized + 'static {
    fn shelf() -> &'static LocalKey<Shelf<Self>>;
}

macro_rules! keep {
    ($($kind:ty),*) => {
        $(impl Keep for $kind {
            fn shelf() -> &'static LocalKey<Shelf<Self>> {
                thread_local! {
                    static SHELF: Shelf<$kind> = const { RefCell::new(Vec::new()) };
                }
                &SHELF
            }
        })*
    };
}

keep!(u8, u16, u32, f32, usize, (u64, u32), [f64; 10], Run);

/// A vector whose memory the next one of its kind takes over.
pub struct Kept<T: Keep>(Vec<T>);

impl<T: Keep> Kept<T> {
    /// An empty one with room for so many: of those kept the smallest that is long enough.
    pub fn with_capacity(wanted: usize) -> Self {
        Self(taken(wanted, Vec::clear))
    }

    /// One of so many elements, some of them left over from earlier: each must be written before it is read.
    pub fn of_any(wanted: usize, element: T) -> Self
    where
        T: Copy,
    {
        Self(taken(wanted, |v| v.resize(wanted, element)))
    }

    /// So many equal ones.
    pub fn of(wanted: usize, element: T) -> Self
    where
        T: Copy,
    {
        let mut kept = Self::with_capacity(wanted);
        kept.resize(wanted, element);
        kept
    }
}

fn taken<T: Keep>(wanted: usize, prepare: impl FnOnce(&mut Vec<T>)) -> Vec<T> {
    let mut taken = T::shelf().with_borrow_mut(|shelf| {
        let fitting = (0..shelf.len())
            .filter(|&n| shelf[n].capacity() >= wanted)
            .min_by_key(|&n| shelf[n].capacity());
        let longest = || (0..shelf.len()).max_by_key(|&n| shelf[n].capacity());
        let place = fitting.or_else(longest);
        place.map_or_else(Vec::new, |n| shelf.swap_remove(n))
    });
    if taken.capacity() < wanted {
        // Nothing of the old content is worth copying.
        taken = Vec::with_capacity(wanted);
    }
    prepare(&mut taken);
    taken
}

impl<T: Keep> Drop for Kept<T> {
    fn drop(&mut self) {
        let used = std::mem::take(&mut self.0);
        let bytes = used.capacity() * size_of::<T>();
        if bytes == 0 || bytes > LONGEST {
            return;
        }
        // A thread that ends keeps nothing.
        let _ = T::shelf().try_with(|shelf| {
            let mut shelf = shelf.borrow_mut();
            if shelf.len() < MOST {
                shelf.push(used);
            }
        });
    }
}

impl<T: Keep> Deref for Kept<T> {
    type Target = Vec<T>;

    fn deref(&self) -> &Vec<T> {
        &self.0
    }
}

impl<T: Keep> DerefMut for Kept<T> {
    fn deref_mut(&mut self) -> &mut Vec<T> {
        &mut self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_comes_back_and_only_where_it_is_long_enough() {
        let first = Kept::of(1000, 7u16);
        let at = first.as_ptr();
        drop(first);
        let again = Kept::<u16>::with_capacity(900);
        assert_eq!((again.as_ptr(), again.len()), (at, 0));
        let other = Kept::of(1000, 9u16);
        assert_ne!(other.as_ptr(), at);
        assert!(other.iter().all(|&n| n == 9));
    }

    #[test]
    fn equal_ones_are_equal_whatever_was_there_before() {
        drop(Kept::of(500, 3u8));
        assert_eq!(**Kept::of(400, 1u8), vec![1u8; 400]);
        assert_eq!(Kept::of_any(450, 0u8).len(), 450);
    }
}
