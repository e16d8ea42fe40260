//! `angioray compare` from outside, peers, the cache of reference pictures, and the page.

#[path = "../cli_place/mod.rs"]
mod cli_place;
#[path = "../common/mod.rs"]
mod common;

mod cli_compare;
mod cli_compare_candidates;
mod fake_peer;
mod peer_vtk;
mod peers_failures;
mod peers_protocol;
mod reference_cache;
mod report_page;
