#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/formats/npy.h"
#include "core/formats/zip_archive.h"

namespace mocurate {

/// One array of an archive.
struct NpzMember {
  std::string name;     ///< without ".npy"
  NpyArray array;       ///< empty when skipped
  std::string skipped;  ///< why the member was not read (Python objects, records, complex numbers); empty when it was
};

struct Npz {
  std::vector<NpzMember> members;  ///< in the order of the archive
  std::vector<Error> unsafe;       ///< of members whose pickle names a class, such as `os system`

  /// Null when it does not exist or was skipped.
  const NpyArray* Find(std::string_view name) const;
};

struct NpzLimits {
  ZipLimits zip;
  std::size_t numbers = std::size_t{1} << 27;  ///< over all members; at most MostUnpacked bytes of them as well
};

/// numpy.savez, packed or not. Members that are neither numbers nor texts are listed and skipped, never
/// executed. Members that are not .npy files are ignored, except that pickles (.pkl, .pickle; PyTorch's archives hold
/// one) are checked for the classes they name. Errors kMalformed (with the member),
/// kUnsupported (limits), kInconsistent (two members of one name).
Expected<Npz> ParseNpz(std::string_view bytes, const std::string& name, const NpzLimits& limits = {});

/// "unsafe_pickle" (warning, at no frame): an unsafe member was skipped while others are read.
Finding UnsafeMember(const Error& unsafe);

/// Not packed, fixed dates: same arrays, same bytes. Errors as of EncodeNpy; skipped members are not written.
Expected<std::string> EncodeNpz(const Npz& npz, const std::string& name);

}  // namespace mocurate
