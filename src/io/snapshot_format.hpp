// Files that show a snapshot to tools for pictures.
#pragma once

namespace eulastic {

/// The XDMF index alone; also a VTKHDF file for each snapshot; or also a file of VTK's XML image data for each.
enum class SnapshotFormat { xdmf, vtkhdf, vti };

}  // namespace eulastic
