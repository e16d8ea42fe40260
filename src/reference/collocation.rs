//! Gauss collocation with five nodes (order 10) for the pair τ' = κ, C' = c κ exp(−τ); see Hairer,
//! Nørsett and Wanner, Solving Ordinary Differential Equations I, II.7.

use std::sync::LazyLock;

/// The number of nodes of the rule.
pub const NODES: usize = 5;

/// Nodes on [0, 1], quadrature weights, and the integrals of the interpolation polynomials from 0
/// to each node.
pub struct Collocation {
    /// The nodes, in [0, 1].
    pub nodes: [f64; NODES],
    /// The weight of each node in the integral from 0 to 1.
    pub weights: [f64; NODES],
    /// `to_node[i][j]`: weight of node j in the integral from 0 to node i.
    pub to_node: [[f64; NODES]; NODES],
}

/// The rule, derived once from the roots of the Legendre polynomial.
pub static GAUSS: LazyLock<Collocation> = LazyLock::new(|| {
    // P5(x) = x (63 x⁴ − 70 x² + 15)/8: its roots in closed form, mapped to [0, 1].
    let root = |sign: f64| ((5.0 + sign * 2.0 * (10.0_f64 / 7.0).sqrt()).sqrt()) / 3.0;
    let (inner, outer) = (root(-1.0), root(1.0));
    let nodes = [-outer, -inner, 0.0, inner, outer].map(|x| 0.5 * (1.0 + x));
    let side = 13.0 * 70.0_f64.sqrt();
    let (inner, outer) = ((322.0 + side) / 1800.0, (322.0 - side) / 1800.0);
    let weights = [outer, inner, 64.0 / 225.0, inner, outer];
    let lagrange = |j: usize, x: f64| {
        (0..NODES)
            .filter(|&k| k != j)
            .map(|k| (x - nodes[k]) / (nodes[j] - nodes[k]))
            .product::<f64>()
    };
    // The polynomials have degree 4: the rule itself integrates them exactly.
    let integral = |j: usize, end: f64| {
        (0..NODES)
            .map(|k| end * weights[k] * lagrange(j, end * nodes[k]))
            .sum::<f64>()
    };
    Collocation {
        nodes,
        weights,
        to_node: std::array::from_fn(|i| std::array::from_fn(|j| integral(j, nodes[i]))),
    }
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_up_to_its_degree_and_not_beyond() {
        let power = |p: i32| -> f64 {
            (0..NODES)
                .map(|i| GAUSS.weights[i] * GAUSS.nodes[i].powi(p))
                .sum()
        };
        for p in 0..10 {
            assert!((power(p) - 1.0 / f64::from(p + 1)).abs() < 1e-15, "{p}");
        }
        assert!((power(10) - 1.0 / 11.0).abs() > 1e-7);
    }

    #[test]
    fn integrals_to_the_nodes_are_exact_to_degree_four() {
        for (i, row) in GAUSS.to_node.iter().enumerate() {
            for p in 0..5 {
                let sum: f64 = (0..NODES).map(|j| row[j] * GAUSS.nodes[j].powi(p)).sum();
                let exact = GAUSS.nodes[i].powi(p + 1) / f64::from(p + 1);
                assert!((sum - exact).abs() < 1e-15);
            }
        }
    }
}
