//! The published methods against the figures and curves of their papers.
