//! Fill-in, with the numbers and without them.

use std::collections::BTreeSet;

use vislam::marginalization::{
    Couplings, Layout, LayoutError, MarginalizationError, WindowSigmas, fill_in, marginalize,
};

use super::{layouts, usual};

fn pairs<const N: usize>(pairs: [(usize, usize); N]) -> BTreeSet<(usize, usize)> {
    pairs.into_iter().collect()
}

#[test]
fn the_first_slide_of_the_chapters_window_couples_one_pair_with_odometry_and_three_without() {
    let layout = Layout::eight_keyframes();
    let gone = layout.slide(0);
    assert_eq!(gone, [8, 9, 10, 0]);
    let with = fill_in(&layout.couplings(), &gone).unwrap();
    assert_eq!(with.new, pairs([(1, 3)]));
    let without = fill_in(&layout.without_odometry().couplings(), &gone).unwrap();
    assert_eq!(without.new, pairs([(1, 2), (1, 3), (2, 3)]));
    assert_eq!(with.blanket, BTreeSet::from([1, 2, 3]));
    assert_eq!(without.blanket, with.blanket);
}

#[test]
fn a_keyframe_alone_couples_the_landmarks_that_it_saw() {
    let layout = Layout::eight_keyframes();
    let alone = fill_in(&layout.couplings(), &[0]).unwrap();
    assert_eq!(alone.new, pairs([(8, 9), (8, 10), (9, 10)]));
    assert_eq!(alone.blanket, BTreeSet::from([1, 8, 9, 10]));
    let last = fill_in(&layout.couplings(), &[7]).unwrap();
    assert_eq!(last.blanket, BTreeSet::from([6, 18, 19]));
}

#[test]
fn numbers_fill_in_where_the_graph_says_and_nowhere_else() {
    for (name, layout) in layouts() {
        let window = usual(&layout).information();
        for gone in [vec![0], vec![4], layout.slide(0), layout.slide(3), vec![layout.landmark(0)]] {
            let predicted = fill_in(&layout.couplings(), &gone).unwrap();
            let found = Couplings::of(&marginalize(&window, &gone).unwrap());
            assert_eq!(found, predicted.couplings, "{name} without {gone:?}");
            let before = layout.couplings().pairs();
            let new: BTreeSet<_> = found.pairs().difference(&before).copied().collect();
            assert_eq!(new, predicted.new);
        }
    }
}

#[test]
fn what_hangs_together_leaves_a_clique_on_its_markov_blanket() {
    for (name, layout) in layouts() {
        for keyframe in 0..layout.keyframes {
            let left = fill_in(&layout.couplings(), &layout.slide(keyframe)).unwrap();
            let pairs = left.couplings.pairs();
            for one in &left.blanket {
                for other in left.blanket.range(one + 1..) {
                    assert!(pairs.contains(&(*one, *other)), "{name}: {one} and {other}");
                }
            }
        }
    }
}

#[test]
fn the_order_changes_the_fill_in_along_the_way_and_not_the_end() {
    let layout = Layout::eight_keyframes();
    let couplings = layout.couplings();
    let landmarks_first = layout.slide(3);
    let keyframe_first: Vec<usize> = landmarks_first.iter().rev().copied().collect();
    let [one, other] = [&landmarks_first, &keyframe_first].map(|o| fill_in(&couplings, o).unwrap());
    println!("{} couplings with landmarks first, {} after", one.along_the_way, other.along_the_way);
    assert_eq!((&one.couplings, &one.new), (&other.couplings, &other.new));
    assert!(2 * one.along_the_way < other.along_the_way);
    let greedy = couplings.fewest_neighbours_first(&keyframe_first).unwrap();
    let best = fill_in(&couplings, &greedy).unwrap();
    assert_eq!(best.couplings, one.couplings);
    assert!(best.along_the_way <= one.along_the_way);
    assert_eq!(greedy.last(), Some(&3));
}

#[test]
fn a_landmark_that_everything_depends_on_couples_everything_and_can_be_refused() {
    let layout = Layout::star(8);
    let landmark = layout.landmark(0);
    let left = fill_in(&layout.couplings(), &[landmark]).unwrap();
    assert!(left.couples_everything());
    assert_eq!(left.new.len(), 8 * 7 / 2 - 7);
    let refused = left.clone().within(20).unwrap_err();
    assert_eq!(refused, MarginalizationError::TooDense { pairs: 21, limit: 20 });
    assert!(refused.to_string().contains("21 pairs"), "{refused}");
    assert_eq!(left.clone().within(21), Ok(left));
    let chain = fill_in(&Layout::eight_keyframes().couplings(), &[8]).unwrap();
    assert!(!chain.couples_everything());
}

#[test]
fn a_keyframe_in_the_middle_of_a_gap_links_its_neighbours_alone() {
    let layout = Layout::gap(8, 3);
    let middle = fill_in(&layout.couplings(), &[4]).unwrap();
    assert_eq!(middle.new, pairs([(3, 5)]));
    let back = fill_in(&layout.couplings(), &layout.slide(0)).unwrap();
    assert_eq!(back.new, pairs([(1, 7)]), "what was seen again links the end with the beginning");
}

#[test]
fn in_a_ring_the_first_slide_couples_both_ends() {
    let ring = Layout::ring(8, 12, 4);
    let left = fill_in(&ring.couplings(), &ring.slide(0)).unwrap();
    assert!(left.new.contains(&(1, 7)));
    assert_eq!(left.blanket, BTreeSet::from([1, 2, 3, 5, 6, 7]));
}

#[test]
fn couplings_are_symmetric_and_nothing_is_coupled_with_itself() {
    let mut couplings = Couplings::new([1, 2]);
    assert!(couplings.couple(1, 2));
    assert!(!couplings.couple(2, 1));
    assert!(!couplings.couple(2, 2));
    assert!(couplings.couple(2, 5));
    let mut last = Couplings::new([1]);
    assert!(last.couple(1, usize::MAX));
    assert_eq!(last.pairs(), BTreeSet::from([(1, usize::MAX)]));
    assert_eq!(couplings.neighbours(2), Some(&BTreeSet::from([1, 5])));
    assert_eq!(couplings.neighbours(9), None);
    assert_eq!(couplings.couple_all(&BTreeSet::from([1, 2, 5])), 1);
    assert!(couplings.is_complete());
}

#[test]
fn a_pattern_refuses_names_that_it_does_not_know() {
    let couplings = Layout::star(3).couplings();
    let refused = |names: &[usize]| fill_in(&couplings, names).unwrap_err();
    assert_eq!(refused(&[]), MarginalizationError::NoneNamed);
    assert_eq!(refused(&[0, 0]), MarginalizationError::Repeated { name: 0 });
    assert_eq!(refused(&[9]), MarginalizationError::Unknown { name: 9, blocks: 4 });
    assert_eq!(refused(&[0, 1, 2, 3]), MarginalizationError::NothingLeft { blocks: 4 });
    let order = couplings.fewest_neighbours_first(&[7]);
    assert_eq!(order, Err(MarginalizationError::Unknown { name: 7, blocks: 4 }));
}

#[test]
fn a_layout_that_is_none_is_refused() {
    let sigmas = WindowSigmas::default();
    let chain = Layout::chain(3, 2, 2);
    let refused = |layout: Layout| layout.problem(&sigmas, 1).err().unwrap();
    let odometry = vec![(0, 3)];
    let beyond = LayoutError::NoSuchKeyframe { keyframe: 3, keyframes: 3 };
    assert_eq!(refused(Layout { odometry, ..chain.clone() }), beyond);
    let odometry = vec![(1, 1)];
    let twice = LayoutError::Repeated { named: vec![1, 1] };
    assert_eq!(refused(Layout { odometry, ..chain.clone() }), twice);
    let seen_by = vec![vec![0], vec![]];
    let unseen = LayoutError::Unseen { landmark: 1 };
    assert_eq!(refused(Layout { seen_by, ..chain.clone() }), unseen);
    assert_eq!(refused(Layout::chain(0, 0, 0)), LayoutError::NoKeyframes);
    let sigma = WindowSigmas { pixel: 0.0, ..sigmas };
    assert_eq!(chain.problem(&sigma, 1).err(), Some(LayoutError::Sigma { sigma: 0.0 }));
    let sigma = WindowSigmas { pixel: f64::INFINITY, ..sigmas };
    assert_eq!(chain.problem(&sigma, 1).err(), Some(LayoutError::Sigma { sigma: f64::INFINITY }));
}

#[test]
fn the_same_seed_makes_the_same_window() {
    let layout = Layout::eight_keyframes();
    let window = |seed| super::window(&layout, &WindowSigmas::default(), seed);
    assert_eq!(window(3), window(3));
    assert_ne!(window(3), window(4));
}

#[test]
fn a_window_whose_first_keyframe_is_not_known_is_free_as_a_whole() {
    let sigmas = WindowSigmas { first_keyframe: f64::INFINITY, ..WindowSigmas::default() };
    let free = |layout: &Layout| {
        let problem = layout.problem(&sigmas, 1).unwrap();
        problem.null_space(problem.values()).unwrap()
    };
    let layout = Layout::eight_keyframes();
    assert_eq!(free(&layout).nullity(), 6);
    // Without odometry the last keyframe can turn about the line through the two landmarks that it saw.
    let without = free(&layout.clone().without_odometry());
    assert_eq!((layout.seen_from(7).len(), without.nullity()), (2, 7));
    assert_eq!(without.within(6 * 7..6 * 8), 1);
}
