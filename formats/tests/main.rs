//! Tests of the container, its checks and its documentation.

mod arbitrary;
mod bytes;
mod c_header;
mod corpus_container;
mod corpus_typed;
mod corrupt_corpus;
mod damage;
mod documentation;
mod export;
mod limits;
mod round_trip;
mod samples;
mod write_atomic;
