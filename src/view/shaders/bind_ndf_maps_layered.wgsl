// A program of NDF maps that may have a coat, see bind_ndf_maps.wgsl.

const NDF_MAPS_LAYERED: bool = true;
