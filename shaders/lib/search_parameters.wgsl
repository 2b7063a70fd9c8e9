// How the search of KR 10-0738500 goes (`extrusion_search.wgsl`). Host: src/relief/search_pass.rs.

struct SearchParameters {
    // Slices of the volume, halvings.
    slices: u32,
    refinements: u32,
    // A surface that rises by more than this over the slice above it is steep, metres.
    delta: f32,
    padding: u32,
}
