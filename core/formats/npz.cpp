#include "core/formats/npz.h"

#include <algorithm>
#include <set>
#include <utility>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/pickle.h"

namespace mocurate {
namespace {

constexpr std::string_view kExtension = ".npy";

}  // namespace

const NpyArray* Npz::Find(std::string_view name) const {
  for (const NpzMember& member : members) {
    if (member.name == name && member.skipped.empty()) return &member.array;
  }
  return nullptr;
}

Expected<Npz> ParseNpz(std::string_view bytes, const std::string& name, const NpzLimits& limits) {
  Expected<ZipArchive> archive = ZipArchive::Open(bytes, name, limits.zip);
  if (!archive) return Forward(archive);
  Npz npz;
  std::set<std::string> names;
  std::size_t numbers = 0;
  const std::size_t most = std::min<std::size_t>(limits.numbers, MostUnpacked(bytes.size()) / sizeof(double));
  for (std::size_t i = 0; i < archive->members().size(); ++i) {
    const std::string& file = archive->members()[i];
    if (EndsWith(file, ".pkl") || EndsWith(file, ".pickle")) {
      const Expected<std::string> pickle = archive->Read(i);
      if (auto foreign = pickle ? ForeignClassIn(*pickle, name + ":" + file) : std::nullopt)
        npz.unsafe.push_back(*std::move(foreign));
    }
    if (!EndsWith(file, kExtension)) continue;
    NpzMember member;
    member.name = file.substr(0, file.size() - kExtension.size());
    const std::string where = name + ":" + member.name;
    if (!names.insert(member.name).second) {
      return Fail(ErrorCode::kInconsistent, "two members have this name", where);
    }
    const Expected<std::string> content = archive->Read(i);
    if (!content) return Forward(content);
    if (const Expected<NpyArray> header = ParseNpyHeader(*content, where); header) {
      std::size_t announced = 1;  // at most as many as there are bytes
      for (const std::size_t extent : header->shape)
        announced = std::min(announced * std::min(extent, content->size()), content->size());
      numbers += announced;
      if (numbers > most) {
        return Fail(ErrorCode::kUnsupported,
                    "more than the " + std::to_string(most) + " numbers that an archive of this size may hold", where,
                    "save the arrays that are needed in a file of their own");
      }
    }
    Expected<NpyArray> array = ParseNpy(*content, where);
    if (array) {
      member.array = std::move(*array);
    } else if (array.error().code == ErrorCode::kUnsupported) {
      member.skipped = array.error().what;
      if (array.error().reason == Reason::kUnsafePickle) npz.unsafe.push_back(array.error());
    } else {
      return Forward(array);
    }
    npz.members.push_back(std::move(member));
  }
  return npz;
}

Finding UnsafeMember(const Error& unsafe) {
  return MakeFinding("unsafe_pickle", Severity::kWarning, 0.0, unsafe.Message() + "; the member is skipped",
                     FindingAction::kExcluded);
}

Expected<std::string> EncodeNpz(const Npz& npz, const std::string& name) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const NpzMember& member : npz.members) {
    const std::string where = name + ":" + member.name;
    if (!member.skipped.empty()) return Fail(ErrorCode::kUnsupported, "a skipped member cannot be written", where);
    Expected<std::string> bytes = EncodeNpy(member.array, where);
    if (!bytes) return Forward(bytes);
    files.emplace_back(member.name + std::string(kExtension), std::move(*bytes));
  }
  return WriteStoredZip(files, name);
}

}  // namespace mocurate
