// What the building passes write for each pixel, and the light pass reads.

struct BuildingTexels {
    // Bits of the distance, id, bits of the facade coordinate (bays along the outline; on a roof its place in the building map in their
    // place, 0 if unknown), packed normal.
    @location(0) surface: vec4<u32>,
    // Bits of the bays a metre (0 on a roof and on a column), of the base, metres above the eye, and of the height of the roof above
    // it, metres; what the building is made of (`facade.wgsl`).
    @location(1) facade: vec4<u32>,
}
