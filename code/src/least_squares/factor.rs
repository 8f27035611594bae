//! What a measurement contributes to a problem.

use nalgebra::{SMatrix, SVector};

use super::linearized::Linearized;
use super::{Key, Manifold, Values};

// ANCHOR: factor
/// A measurement as an estimator uses it: a residual of `R` numbers, prediction minus measurement
/// in standard deviations, that depends on a few variables.
pub trait Factor<const R: usize>: Send + Sync + 'static {
    /// The kinds of its variables, as in `(Isometry3<f64>, Vector3<f64>)`.
    type Variables: Variables;

    /// The derivatives by a step of each, as in `(SMatrix<f64, R, 6>, SMatrix<f64, R, 3>)`.
    type Jacobians: Jacobians<R>;

    /// Which variables, each of them once.
    fn variables(&self) -> <Self::Variables as Variables>::Keys;

    /// The residual, or `None` where it has no value, as the pixel of a point behind the camera
    /// has none.
    fn residual(
        &self,
        values: <Self::Variables as Variables>::References<'_>,
    ) -> Option<SVector<f64, R>>;

    /// The residual and its derivatives.
    fn linearize(
        &self,
        values: <Self::Variables as Variables>::References<'_>,
    ) -> Option<(SVector<f64, R>, Self::Jacobians)>;
}
// ANCHOR_END: factor

/// The kinds of the variables that a factor depends on: a tuple of up to six of them.
pub trait Variables {
    /// A [`Key`] for each.
    type Keys: Copy;
    /// The value of each.
    type References<'a>;
    /// All values of each kind.
    type Lists<'a>: Copy;

    /// The lists of all values of these kinds.
    fn lists(values: &Values) -> Self::Lists<'_>;

    /// The values that the keys name.
    fn pick<'a>(lists: Self::Lists<'a>, keys: &Self::Keys) -> Self::References<'a>;

    /// The numbers of the variables, in order.
    fn indices(keys: &Self::Keys, visit: &mut dyn FnMut(usize));

    /// The number of the first key that is none of a variable of these values.
    fn missing(keys: &Self::Keys, values: &Values) -> Option<usize>;
}

/// The derivatives of a residual of `R` numbers by each of its variables: a tuple of matrices of
/// `R` rows.
pub trait Jacobians<const R: usize> {
    /// Columns of each.
    const COLUMNS: &'static [usize];

    /// Writes them as those of the factor at this place, times a weight.
    fn write(&self, factor: usize, weight: f64, into: &mut Linearized);
}

macro_rules! tuple {
    ($($kind:ident $columns:ident $slot:tt),+) => {
        impl<$($kind: Manifold),+> Variables for ($($kind,)+) {
            type Keys = ($(Key<$kind>,)+);
            type References<'a> = ($(&'a $kind,)+);
            type Lists<'a> = ($(&'a [$kind],)+);

            #[inline(always)]
            fn lists(values: &Values) -> Self::Lists<'_> {
                ($(values.of_kind::<$kind>(),)+)
            }

            #[inline(always)]
            fn pick<'a>(lists: Self::Lists<'a>, keys: &Self::Keys) -> Self::References<'a> {
                ($(&lists.$slot[keys.$slot.place as usize],)+)
            }

            #[inline]
            fn indices(keys: &Self::Keys, visit: &mut dyn FnMut(usize)) {
                $(visit(keys.$slot.index());)+
            }

            fn missing(keys: &Self::Keys, values: &Values) -> Option<usize> {
                $(let known = values.key::<$kind>(keys.$slot.index());
                if known.is_none_or(|known| known.place != keys.$slot.place) {
                    return Some(keys.$slot.index());
                })+
                None
            }
        }

        impl<const R: usize, $(const $columns: usize),+> Jacobians<R>
            for ($(SMatrix<f64, R, $columns>,)+)
        {
            const COLUMNS: &'static [usize] = &[$($columns),+];

            #[inline(always)]
            fn write(&self, factor: usize, weight: f64, into: &mut Linearized) {
                $(into.write_jacobian(factor, $slot, weight, &self.$slot);)+
            }
        }
    };
}

tuple!(A A_COLUMNS 0);
tuple!(A A_COLUMNS 0, B B_COLUMNS 1);
tuple!(A A_COLUMNS 0, B B_COLUMNS 1, C C_COLUMNS 2);
tuple!(A A_COLUMNS 0, B B_COLUMNS 1, C C_COLUMNS 2, D D_COLUMNS 3);
tuple!(A A_COLUMNS 0, B B_COLUMNS 1, C C_COLUMNS 2, D D_COLUMNS 3, E E_COLUMNS 4);
tuple!(A A_COLUMNS 0, B B_COLUMNS 1, C C_COLUMNS 2, D D_COLUMNS 3, E E_COLUMNS 4, F F_COLUMNS 5);
