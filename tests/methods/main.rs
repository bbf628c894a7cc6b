//! Every method under the one signature: properties that all share, failure modes, and the figures of the papers.

mod fixture;
mod papers;
mod properties;
mod sweep;
