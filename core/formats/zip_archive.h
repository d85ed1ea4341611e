#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// Bounds on what an archive may request, whatever it declares.
struct ZipLimits {
  std::size_t members = 1u << 20;
  std::size_t bytes = std::size_t{1} << 30;  ///< unpacked, over all members that are read; at most MostUnpacked as well
};

/// A zip archive in memory, read through libzip. A member that declares more than the limits is not unpacked, and one
/// that unpacks to more than it declares no further.
class ZipArchive {
 public:
  /// `bytes` must outlive the archive. Errors kMalformed, kUnsupported (too many members).
  static Expected<ZipArchive> Open(std::string_view bytes, const std::string& name, const ZipLimits& limits = {});
  ZipArchive(ZipArchive&&) noexcept;
  ZipArchive& operator=(ZipArchive&&) noexcept;
  ~ZipArchive();

  /// In the order of the archive.
  const std::vector<std::string>& members() const { return members_; }
  /// The unpacked bytes of members()[index]. Errors kMalformed (damaged, checksum), kUnsupported (encrypted, unknown
  /// packing, more bytes than the limits).
  Expected<std::string> Read(std::size_t index);

 private:
  struct Handle;
  ZipArchive() = default;

  std::unique_ptr<Handle> handle_;
  std::string name_;
  ZipLimits limits_;
  std::size_t unpacked_ = 0;
  std::vector<std::string> members_;
};

/// A stored (not packed) archive of (name, bytes), dated 1980-01-01: same content, same bytes. Errors kUnsupported (4
/// GiB or 65,535 members and more), kCannotWrite.
Expected<std::string> WriteStoredZip(const std::vector<std::pair<std::string, std::string>>& members,
                                     const std::string& name);

}  // namespace mocurate
