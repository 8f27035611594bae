//! What is no Gaussian, or cannot be asked.

use nalgebra::{DMatrix, DVector};
use vislam::marginalization::{
    Block, Blocks, Information, Layout, MarginalizationError, OverConfidence, SquareRoot,
    divergence, keep_marginals, marginalize, sparsify, zero_link,
};

use super::{blocks, numbers, usual};

#[test]
fn blocks_have_names_of_their_own_and_coordinates() {
    let of = |list: &[(usize, usize)]| {
        let block = |&(name, dimension): &(usize, usize)| Block { name, dimension };
        Blocks::new(list.iter().map(block).collect())
    };
    assert_eq!(of(&[]), Err(MarginalizationError::NoneNamed));
    assert_eq!(of(&[(3, 1), (3, 2)]), Err(MarginalizationError::Repeated { name: 3 }));
    assert_eq!(of(&[(3, 1), (4, 0)]), Err(MarginalizationError::EmptyBlock { name: 4 }));
    let blocks = of(&[(7, 2), (3, 4)]).unwrap();
    assert_eq!(blocks.columns_of(3), Ok(2..6));
    assert_eq!((blocks.len(), blocks.dimension(), blocks.is_empty()), (2, 6, false));
}

#[test]
fn a_matrix_that_does_not_fit_is_refused() {
    let information = |matrix, vector| Information::new(blocks(&[2, 1]), matrix, vector);
    let zeros = DVector::<f64>::zeros(3);
    let refused = information(DMatrix::identity(3, 2), zeros.clone()).unwrap_err();
    let shape = MarginalizationError::Shape { rows: 3, columns: 2, numbers: 3, dimension: 3 };
    assert_eq!(refused, shape);
    let mut matrix = DMatrix::identity(3, 3);
    matrix[(1, 2)] = 0.5;
    let refused = information(matrix.clone(), zeros.clone()).unwrap_err();
    assert_eq!(refused, MarginalizationError::NotSymmetric { asymmetry: 0.5 });
    matrix[(1, 2)] = f64::NAN;
    let refused = information(matrix, zeros.clone()).unwrap_err();
    assert_eq!(refused, MarginalizationError::NotFinite { row: 1 });
    let infinite = DVector::from_vec(vec![0.0, 0.0, f64::INFINITY]);
    let refused = SquareRoot::new(blocks(&[2, 1]), DMatrix::identity(3, 3), infinite).unwrap_err();
    assert_eq!(refused, MarginalizationError::NotFinite { row: 2 });
    let refused = SquareRoot::new(blocks(&[2, 1]), DMatrix::identity(2, 3), zeros).unwrap_err();
    let shape = MarginalizationError::Shape { rows: 2, columns: 3, numbers: 3, dimension: 3 };
    assert_eq!(refused, shape);
}

#[test]
fn names_are_checked_in_both_forms() {
    let window = usual(&Layout::star(3));
    let information = window.information();
    for (names, error) in [
        (vec![], MarginalizationError::NoneNamed),
        (vec![1, 1], MarginalizationError::Repeated { name: 1 }),
        (vec![12], MarginalizationError::Unknown { name: 12, blocks: 4 }),
        (vec![3, 2, 1, 0], MarginalizationError::NothingLeft { blocks: 4 }),
    ] {
        assert_eq!(marginalize(&information, &names), Err(error.clone()));
        assert_eq!(window.marginalize(&names), Err(error.clone()));
        assert_eq!(window.drop_blocks(&names), Err(error.clone()));
        assert_eq!(information.hold_blocks(&names), Err(error));
    }
    let unknown = MarginalizationError::Unknown { name: 12, blocks: 4 };
    assert_eq!(information.between(0, 12).err(), Some(unknown.clone()));
    assert_eq!(zero_link(&information, 12, 1), Err(unknown.clone()));
    assert_eq!(sparsify(&information, 0, &[12]), Err(unknown.clone()));
    assert_eq!(OverConfidence::of_block(&information, &information, 12), Err(unknown));
}

#[test]
fn a_singular_block_is_named_with_what_is_left_of_it() {
    // Of block 1 two coordinates are measured by their sum alone.
    let mut rows = DMatrix::zeros(4, 4);
    rows[(0, 0)] = 2.0;
    (rows[(1, 1)], rows[(1, 2)], rows[(1, 3)]) = (1.0, 1.0, 0.5);
    (rows[(2, 1)], rows[(2, 2)], rows[(2, 0)]) = (3.0, 3.0, 1.0);
    rows[(3, 3)] = 1.0;
    let window = SquareRoot::new(blocks(&[1, 2, 1]), rows, DVector::zeros(4)).unwrap();
    for refused in [
        marginalize(&window.information(), &[0, 1]).err(),
        window.marginalize(&[0, 1]).err(),
        SquareRoot::of_information(&window.information()).err(),
        window.information().mean().err(),
    ] {
        let Some(MarginalizationError::Singular { name: 1, pivot }) = refused else {
            panic!("{refused:?}");
        };
        assert!(pivot.abs() < 1e-14);
    }
    assert!(window.marginalize(&[0, 2]).is_ok());
}

#[test]
fn a_block_that_nothing_measures_is_singular() {
    let mut rows = DMatrix::<f64>::identity(3, 3);
    rows[(1, 1)] = 0.0;
    let window = SquareRoot::new(blocks(&[1, 1, 1]), rows, DVector::zeros(3)).unwrap();
    let singular = MarginalizationError::Singular { name: 1, pivot: 0.0 };
    assert_eq!(marginalize(&window.information(), &[1]), Err(singular.clone()));
    assert_eq!(window.marginalize(&[1]), Err(singular));
}

#[test]
fn an_indefinite_block_is_named_and_so_is_one_that_elimination_makes_indefinite() {
    let negative = numbers(DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, -2.0, 1.0])));
    let indefinite = MarginalizationError::Indefinite { name: 1, pivot: -1.0 };
    assert_eq!(marginalize(&negative, &[0, 1]), Err(indefinite));
    let hidden =
        numbers(DMatrix::from_row_slice(3, 3, &[1.0, 2.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0]));
    assert!(marginalize(&hidden, &[1]).is_ok(), "it alone has information of its own");
    let refused = marginalize(&hidden, &[0, 1]).unwrap_err();
    assert_eq!(refused, MarginalizationError::Indefinite { name: 1, pivot: -3.0 });
    assert!(refused.to_string().contains("block 1"), "{refused}");
    assert_eq!(hidden.covariance().unwrap_err(), refused);
}

#[test]
fn gaussians_of_different_blocks_are_not_compared() {
    let window = usual(&Layout::star(3)).information();
    let other = marginalize(&window, &[3]).unwrap();
    let different = MarginalizationError::DifferentBlocks;
    assert_eq!(divergence(&window, &other), Err(different.clone()));
    assert_eq!(OverConfidence::of(&window, &other), Err(different));
    let turned = window.select(&[3, 2, 1, 0]).unwrap();
    assert!(divergence(&window, &turned.select(&[0, 1, 2, 3]).unwrap()).is_ok());
}

#[test]
fn a_link_that_is_not_there_cannot_be_dropped() {
    let window = usual(&Layout::star(4)).information();
    let none = MarginalizationError::NoLink { first: 0, second: 2 };
    assert_eq!(zero_link(&window, 0, 2), Err(none.clone()));
    assert_eq!(keep_marginals(&window, 0, 2), Err(none.clone()));
    assert_eq!(sparsify(&window, 0, &[1, 2]), Err(none));
    let itself = MarginalizationError::NoLink { first: 1, second: 1 };
    assert_eq!(zero_link(&window, 1, 1), Err(itself));
    assert_eq!(sparsify(&window, 0, &[]), Err(MarginalizationError::NoneNamed));
    assert_eq!(sparsify(&window, 0, &[1, 1]), Err(MarginalizationError::Repeated { name: 1 }));
}
