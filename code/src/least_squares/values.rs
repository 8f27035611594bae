//! Values of variables of several kinds, each kind in a list of its own.

use std::any::Any;
use std::fmt;
use std::marker::PhantomData;
use std::ops::{Index, Range};

use super::Manifold;

// ANCHOR: key
/// A variable of a problem, and of which kind it is.
pub struct Key<V> {
    /// Its number among all variables of the problem, in the order in which they were added.
    pub(super) index: u32,
    /// Its place among those of its kind.
    pub(super) place: u32,
    kind: PhantomData<fn() -> V>,
}
// ANCHOR_END: key

impl<V> Key<V> {
    /// Its number among all variables of the problem, in the order in which they were added.
    pub fn index(&self) -> usize {
        self.index as usize
    }
}

impl<V> Clone for Key<V> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<V> Copy for Key<V> {}

impl<V> PartialEq for Key<V> {
    fn eq(&self, other: &Self) -> bool {
        self.index == other.index
    }
}

impl<V> Eq for Key<V> {}

impl<V> fmt::Debug for Key<V> {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "Key({})", self.index)
    }
}

// ANCHOR: values
/// A value for each variable. `values[key]` is that of one.
#[derive(Clone, Default)]
pub struct Values {
    /// One list for each kind of variable.
    kinds: Vec<Box<dyn Kind>>,
    /// For each variable its kind, its place there, and where its coordinates begin in a step of
    /// all variables.
    variables: Vec<Place>,
    coordinates: usize,
}
// ANCHOR_END: values

#[derive(Clone, Copy, PartialEq)]
struct Place {
    kind: u32,
    place: u32,
    start: usize,
    dimension: usize,
}

impl Values {
    /// No variables.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a variable.
    pub fn add<V: Manifold>(&mut self, value: V) -> Key<V> {
        let dimension = value.dimension();
        let kind = self.kinds.iter().position(|kind| is_list::<V>(&**kind));
        let kind = kind.unwrap_or_else(|| {
            self.kinds.push(Box::new(Vec::<V>::new()));
            self.kinds.len() - 1
        });
        let list: &mut dyn Any = &mut *self.kinds[kind];
        let list = list.downcast_mut::<Vec<V>>().expect("the list was found by its kind");
        list.push(value);
        let (index, place) = (self.variables.len() as u32, list.len() as u32 - 1);
        let start = self.coordinates;
        self.variables.push(Place { kind: kind as u32, place, start, dimension });
        self.coordinates += dimension;
        Key { index, place, kind: PhantomData }
    }

    /// The number of variables.
    pub fn len(&self) -> usize {
        self.variables.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.variables.is_empty()
    }

    /// The number of coordinates of all variables together, which is the length of a step.
    pub fn dimension(&self) -> usize {
        self.coordinates
    }

    /// Where the coordinates of a variable stand in a step; `None` when there is no such variable.
    pub fn coordinates_of(&self, index: usize) -> Option<Range<usize>> {
        let Place { start, dimension, .. } = self.variables.get(index)?;
        Some(*start..start + dimension)
    }

    /// All values of one kind, in the order in which they were added.
    pub fn of_kind<V: Manifold>(&self) -> &[V] {
        self.kinds.iter().find_map(|kind| list::<V>(&**kind)).unwrap_or(&[])
    }

    fn of_kind_mut<V: Manifold>(&mut self) -> &mut [V] {
        self.kinds.iter_mut().find_map(|kind| list_mut::<V>(&mut **kind)).unwrap_or(&mut [])
    }

    /// The key of a variable, if it is of this kind.
    pub fn key<V: Manifold>(&self, index: usize) -> Option<Key<V>> {
        let Place { kind, place, .. } = *self.variables.get(index)?;
        let is_kind = is_list::<V>(&*self.kinds[kind as usize]);
        is_kind.then_some(Key { index: index as u32, place, kind: PhantomData })
    }

    /// The value of a variable; `None` when there is none of its kind and place. A key of another
    /// problem can be that of another variable here.
    pub fn get<V: Manifold>(&self, key: Key<V>) -> Option<&V> {
        self.of_kind().get(key.place as usize)
    }

    /// Gives a variable another value. False, and nothing happens, when [`Values::get`] finds none or
    /// the dimension differs.
    pub fn set<V: Manifold>(&mut self, key: Key<V>, value: V) -> bool {
        match self.of_kind_mut::<V>().get_mut(key.place as usize) {
            Some(place) if place.dimension() == value.dimension() => {
                *place = value;
                true
            }
            _ => false,
        }
    }

    /// Whether both are values of the same variables.
    pub fn fits(&self, other: &Self) -> bool {
        let same_kinds = || {
            let mut pairs = self.kinds.iter().zip(&other.kinds);
            pairs.all(|(one, other)| (**one).type_id() == (**other).type_id())
        };
        self.variables == other.variables && same_kinds()
    }

    // ANCHOR: retract_all
    /// Moves each variable by its part of a step of all coordinates, into values of the same
    /// variables.
    pub fn retract_into(&self, step: &[f64], into: &mut Self) {
        for (number, (kind, into)) in self.kinds.iter().zip(&mut into.kinds).enumerate() {
            let of_kind = |place: &&Place| place.kind as usize == number;
            kind.retract_into(&mut self.variables.iter().filter(of_kind), step, &mut **into);
        }
    }
    // ANCHOR_END: retract_all

    /// The values after a step of all coordinates.
    pub fn retract(&self, step: &[f64]) -> Self {
        let mut moved = self.clone();
        self.retract_into(step, &mut moved);
        moved
    }

    /// The step that leads from these values to others of the same variables.
    pub fn local(&self, to: &Self) -> Vec<f64> {
        let mut step = vec![0.0; self.coordinates];
        for place in &self.variables {
            let kind = place.kind as usize;
            let part = &mut step[place.start..place.start + place.dimension];
            let own = place.place as usize;
            self.kinds[kind].local(own, &*to.kinds[kind], own, part);
        }
        step
    }

    /// The values of some variables alone, in this order. `None` when one does not exist.
    pub fn select(&self, variables: &[usize]) -> Option<Self> {
        let mut kinds: Vec<Box<dyn Kind>> = self.kinds.iter().map(|kind| kind.empty()).collect();
        let mut selected = Self::new();
        for variable in variables {
            let Place { kind, place, dimension, .. } = *self.variables.get(*variable)?;
            let own = kinds[kind as usize].push(&*self.kinds[kind as usize], place as usize);
            let start = selected.coordinates;
            selected.variables.push(Place { kind, place: own, start, dimension });
            selected.coordinates += dimension;
        }
        selected.kinds = kinds;
        Some(selected)
    }

    /// Calls with the lists and the places of a variable here and of one elsewhere, when they are of
    /// one kind and dimension.
    fn beside<T>(
        &self,
        own: usize,
        (other, variable): (&Self, usize),
        call: impl FnOnce((&dyn Kind, usize), (&dyn Kind, usize)) -> T,
    ) -> Option<T> {
        let (from, to) = (self.variables.get(own)?, other.variables.get(variable)?);
        let (own, other) = (&*self.kinds[from.kind as usize], &*other.kinds[to.kind as usize]);
        let is_alike = own.type_id() == other.type_id() && from.dimension == to.dimension;
        is_alike.then(|| call((own, from.place as usize), (other, to.place as usize)))
    }

    /// Whether a variable is of the kind and dimension of one of other values.
    pub(super) fn is_like(&self, own: usize, other: (&Self, usize)) -> bool {
        self.beside(own, other, |_, _| ()).is_some()
    }

    /// Writes the step from a variable to one of other values. `None` when they are not of one kind
    /// and dimension.
    pub(super) fn local_to(
        &self,
        own: usize,
        other: (&Self, usize),
        step: &mut [f64],
    ) -> Option<()> {
        self.beside(own, other, |(own, from), (other, to)| own.local(from, other, to, step))
    }

    /// Writes the derivative of that step.
    pub(crate) fn local_jacobian_to(
        &self,
        own: usize,
        other: (&Self, usize),
        into: &mut [f64],
    ) -> Option<()> {
        self.beside(own, other, |(own, from), (other, to)| {
            own.local_jacobian(from, other, to, into)
        })
    }

    /// Copies the value of one variable from values of the same variables.
    pub(super) fn copy(&mut self, from: &Self, index: usize) {
        self.copy_of(index, (from, index));
    }

    /// Gives a variable the value of one of other values. Nothing happens when they are not of one
    /// kind and dimension.
    pub(super) fn copy_of(&mut self, own: usize, (from, variable): (&Self, usize)) {
        if self.is_like(own, (from, variable)) {
            let (to, place) = (self.variables[own], from.variables[variable]);
            let list = &mut self.kinds[to.kind as usize];
            list.copy(to.place as usize, &*from.kinds[place.kind as usize], place.place as usize);
        }
    }
}

impl<V: Manifold> Index<Key<V>> for Values {
    type Output = V;

    fn index(&self, key: Key<V>) -> &V {
        &self.of_kind()[key.place as usize]
    }
}

impl fmt::Debug for Values {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "Values of {} variables", self.len())
    }
}

/// All values of one kind, whichever it is. A call goes through a whole list.
trait Kind: Any + Send + Sync {
    fn boxed(&self) -> Box<dyn Kind>;
    fn retract_into(
        &self,
        places: &mut dyn Iterator<Item = &Place>,
        step: &[f64],
        into: &mut dyn Kind,
    );
    fn local(&self, place: usize, to: &dyn Kind, to_place: usize, step: &mut [f64]);
    fn local_jacobian(&self, place: usize, to: &dyn Kind, to_place: usize, into: &mut [f64]);
    fn empty(&self) -> Box<dyn Kind>;
    fn push(&mut self, from: &dyn Kind, place: usize) -> u32;
    fn copy(&mut self, place: usize, from: &dyn Kind, from_place: usize);
}

fn is_list<V: Manifold>(kind: &dyn Kind) -> bool {
    list::<V>(kind).is_some()
}

/// The list, if it is one of this kind.
fn list<V: Manifold>(kind: &dyn Kind) -> Option<&[V]> {
    let any: &dyn Any = kind;
    any.downcast_ref::<Vec<V>>().map(Vec::as_slice)
}

fn list_mut<V: Manifold>(kind: &mut dyn Kind) -> Option<&mut [V]> {
    let any: &mut dyn Any = kind;
    any.downcast_mut::<Vec<V>>().map(Vec::as_mut_slice)
}

impl<V: Manifold> Kind for Vec<V> {
    fn boxed(&self) -> Box<dyn Kind> {
        Box::new(self.clone())
    }

    fn retract_into(
        &self,
        places: &mut dyn Iterator<Item = &Place>,
        step: &[f64],
        into: &mut dyn Kind,
    ) {
        let Some(into) = list_mut::<V>(into) else { return };
        for (place, (value, moved)) in places.zip(self.iter().zip(into)) {
            let step = &step[place.start..place.start + place.dimension];
            let stays = step.iter().all(|number| *number == 0.0);
            *moved = if stays { value.clone() } else { value.retract(step) };
        }
    }

    fn local(&self, place: usize, to: &dyn Kind, to_place: usize, step: &mut [f64]) {
        if let Some(to) = list::<V>(to) {
            self[place].local(&to[to_place], step);
        }
    }

    fn local_jacobian(&self, place: usize, to: &dyn Kind, to_place: usize, into: &mut [f64]) {
        if let Some(to) = list::<V>(to) {
            self[place].local_jacobian(&to[to_place], into);
        }
    }

    fn empty(&self) -> Box<dyn Kind> {
        Box::new(Self::new())
    }

    fn push(&mut self, from: &dyn Kind, place: usize) -> u32 {
        self.extend(list::<V>(from).map(|from| from[place].clone()));
        self.len() as u32 - 1
    }

    fn copy(&mut self, place: usize, from: &dyn Kind, from_place: usize) {
        if let Some(from) = list::<V>(from) {
            self[place] = from[from_place].clone();
        }
    }
}

impl Clone for Box<dyn Kind> {
    fn clone(&self) -> Self {
        self.as_ref().boxed()
    }
}
