//! Many recordings: traces of a list of them, resumable, and models of one specimen over time beside each other.
