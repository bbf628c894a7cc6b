//! Every method under the one signature: properties that all share, failure modes, and the figures of the papers.

#![expect(clippy::unwrap_used, clippy::panic, reason = "the helpers of a test may panic as the test itself may")]

mod fixture;
mod papers;
mod partitioned;
mod permuted;
mod properties;
mod several;
mod sweep;
