#pragma once

#include <hdf5.h>

namespace mocurate::store {

/// An open file that HDF5 writes through `DescriptorDriver`. Nothing fails inside HDF5, which cannot go on after a
/// failed write: the first error is kept here and what follows is thrown away.
struct DescriptorFile {
  int descriptor = -1;    ///< of an empty file, open for reading and writing; not closed here
  int error = 0;          ///< errno of the first write that failed; 0: none did
  bool finished = false;  ///< nothing is written any more
};

/// File access properties for `file`, which must outlive the HDF5 file; its name does not matter. Space is given out as
/// by HDF5's driver for files in memory: the same calls make the same bytes.
hid_t DescriptorAccess(DescriptorFile& file);

}  // namespace mocurate::store
