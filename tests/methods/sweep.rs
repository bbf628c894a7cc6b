//! Dueling frusta.
