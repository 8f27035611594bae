//! What it takes to eliminate one variable from a Gaussian in information form.

use nalgebra::{DMatrix, DVector};
use vislam::marginalization::{
    Block, Blocks, Information, Layout, SquareRoot, WindowSigmas, marginalize,
};

use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::counter::Counter;
use crate::msckf::rotations;
use crate::random::Random;

/// Products by the coordinates of what is eliminated and of what it is coupled with.
type Products = fn(f64, f64) -> f64;

/// The formula of the chapter.
pub fn products(own: f64, reach: f64) -> f64 {
    own * (own - 1.0) * (own + 4.0) / 6.0
        + own * (own + 1.0) * (reach + 1.0) / 2.0
        + own * reach * (reach + 3.0) / 2.0
}

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Products); 3] = [
        ("both halves of the square", |a, r| products(a, r) + a * r * (r - 1.0) / 2.0),
        ("the factorization forgotten", |a, r| products(a, r) - a * (a - 1.0) * (a + 4.0) / 6.0),
        ("the vector forgotten", |a, r| products(a, r) - a * r - a * (a + 1.0) / 2.0),
    ];
    chapter.equation("elimination-products", elimination_products, products, &mutants);
    let (sights, longer) = (11.0, 110.0);
    // Both have six columns for the camera's place on the body. A pair is turned by four products.
    let schur = |sights: f64| products(3.0, 6.0 * sights + 6.0);
    let turned = |sights: f64| 4.0 * rotations::counted(sights as usize) as f64;
    chapter.number("schur_11", schur(sights), "", 0);
    chapter.number("turned_11", turned(sights), "", 0);
    chapter.number("turned_ratio_11", turned(sights) / schur(sights), "", 1);
    chapter.number("turned_ratio_110", turned(longer) / schur(longer), "", 2);
    let window = Layout::eight_keyframes();
    let keyframe = 3;
    let mut backwards = window.slide(keyframe);
    backwards.rotate_right(1);
    let [first, last] = [backwards, window.slide(keyframe)].map(|gone| of_window(&window, &gone));
    chapter.number("keyframe_first", first, "", 0);
    chapter.number("landmarks_first", last, "", 0);
    chapter.number("order_ratio", first / last, "", 1);
}

/// Products that taking blocks out of a window takes, in this order.
pub fn of_window(layout: &Layout, gone: &[usize]) -> f64 {
    let problem = layout.problem(&WindowSigmas::default(), 1).expect("a window");
    let window = SquareRoot::of_problem(&problem, problem.values()).expect("it is linearized");
    let (mut left, mut sum) = (window.information(), 0.0);
    for name in gone {
        let own = left.blocks().columns_of(*name).expect("it is there");
        let rows = left.matrix().rows_range(own.clone()).into_owned();
        let coupled = |column: &usize| !own.contains(column) && rows.column(*column).amax() > 0.0;
        let reach = (0..rows.ncols()).filter(coupled).count();
        sum += products(own.len() as f64, reach as f64);
        left = marginalize(&left, &[*name]).expect("it is determined");
    }
    sum
}

fn elimination_products(formula: Products) -> Comparison {
    let against = "a copy of the elimination that counts, and whose results are the library's";
    let states: Vec<(usize, usize)> =
        (1..=9).flat_map(|own| (1..=40).step_by(3).map(move |reach| (own, reach))).collect();
    Comparison::absolute(against, 0.5, "products").each(states, |(own, reach)| {
        (formula(own as f64, reach as f64), counted(own, reach) as f64)
    })
}

/// Eliminates the first of two blocks and counts.
fn counted(own: usize, reach: usize) -> usize {
    let mut random = Random::new(9);
    let size = own + reach;
    let root = DMatrix::from_fn(2 * size, size, |_, _| random.normal(1.0));
    let (matrix, vector) = (root.tr_mul(&root), DVector::from_fn(size, |_, _| random.normal(1.0)));
    let counter = Counter::default();
    let lower = counter.cholesky(&matrix.view((0, 0), (own, own)).into_owned());
    let half = counter.solve_lower(&lower, &matrix.view((0, own), (own, reach)).into_owned());
    let known = DMatrix::from_column_slice(own, 1, vector.rows(0, own).into_owned().as_slice());
    let known = counter.solve_lower(&lower, &known).column(0).into_owned();
    let vector_left = vector.rows(own, reach) - counter.transposed_times(&half, &known);
    let mut left = matrix.view((own, own), (reach, reach)).into_owned();
    counter.less_square(&mut left, &half);

    let block = |(name, dimension)| Block { name, dimension };
    let blocks = Blocks::new([own, reach].into_iter().enumerate().map(block).collect());
    let window = Information::new(blocks.expect("two blocks"), matrix, vector);
    let library = marginalize(&window.expect("a Gaussian"), &[0]).expect("it is determined");
    let apart = (library.matrix() - &left).amax() / left.amax();
    let apart = apart.max((library.vector() - &vector_left).amax() / vector_left.amax());
    assert!(apart < 1e-10, "the counted elimination is that of the library: {apart}");
    counter.products()
}
