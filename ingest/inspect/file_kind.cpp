#include "ingest/inspect/file_kind.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/line_reader.h"
#include "core/formats/number_scanner.h"
#include "core/formats/pickle.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostKeys = 64;

bool StartsWith(std::string_view text, std::string_view begin) { return text.substr(0, begin.size()) == begin; }

/// Lines of the head, trimmed, without the last one, which may be cut off.
std::vector<std::string_view> LinesOf(std::string_view bytes) {
  std::string_view head = bytes.substr(0, kKindHead);
  if (bytes.size() >= kKindHead) head = head.substr(0, std::max<std::size_t>(head.rfind('\n') + 1, 1));
  std::vector<std::string_view> lines = SplitText(head, '\n');
  for (std::string_view& line : lines) line = Trim(line);
  return lines;
}

std::size_t NumbersIn(std::string_view line) {
  std::size_t numbers = 0;
  for (const std::string_view word : SplitBlanks(line)) {
    if (Trim(word).empty()) continue;
    if (!ParseDouble(Trim(word))) return 0;
    ++numbers;
  }
  return numbers;
}

/// Counts of frames and bodies, the body's 10 numbers, a count of joints, which its reader judges, and 12 numbers of a
/// joint; before them frames without a body.
bool IsNtuSkeleton(const std::vector<std::string_view>& lines) {
  if (lines.size() < 5 || !ParseInteger(lines[0])) return false;
  std::size_t at = 1;
  while (at < lines.size() && lines[at] == "0") ++at;
  return at + 3 < lines.size() && ParseInteger(lines[at]) && NumbersIn(lines[at + 1]) == 10 &&
         ParseInteger(lines[at + 2]) && NumbersIn(lines[at + 3]) == 12;
}

/// Acclaim files begin with a section or keyword behind a colon, after comments.
FileKind AcclaimKind(const std::vector<std::string_view>& lines) {
  for (const std::string_view line : lines) {
    if (line.empty() || line[0] == '#') continue;
    if (line[0] != ':') return FileKind::kUnknown;
    std::string word(SplitBlanks(line)[0]);
    for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    for (const char* section : {":version", ":name", ":units", ":documentation", ":root", ":bonedata"}) {
      if (word == section) return FileKind::kAsf;
    }
    for (const char* keyword : {":fully-specified", ":degrees", ":radians", ":samples-per-second"}) {
      if (word == keyword) return FileKind::kAmc;
    }
    return FileKind::kUnknown;
  }
  return FileKind::kUnknown;
}

/// An Acclaim motion whose header is gone: a frame number, then names with numbers behind them.
bool IsBareAmc(const std::vector<std::string_view>& lines) {
  constexpr std::size_t kFewestRows = 4;
  std::size_t rows = 0;
  bool numbered = false;
  for (const std::string_view line : lines) {
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string_view> words = SplitBlanks(line);
    if (!numbered) {
      if (words.size() != 1 || !ParseInteger(words[0])) return false;
      numbered = true;
      continue;
    }
    if (ParseDouble(words[0])) return rows >= kFewestRows && words.size() == 1;
    if (words.size() < 2 || NumbersIn(line.substr(words[0].size())) != words.size() - 1) return false;
    ++rows;
  }
  return rows >= kFewestRows;
}

/// Open3D's trajectories look like tables: three numbers, then a 4 x 4 matrix.
bool IsTrajectory(const std::vector<std::string_view>& lines) {
  if (lines.size() < 5 || NumbersIn(lines[0]) != 3 || NumbersIn(lines[1]) != 4) return false;
  const std::vector<std::string_view> last = SplitBlanks(lines[4]);
  for (std::size_t i = 0; i < last.size(); ++i) {
    if (ParseDouble(Trim(last[i])) != (i == 3 ? 1.0 : 0.0)) return false;
  }
  return last.size() == 4;
}

/// Numbers of a line of a table, or how many words where it holds words alone.
struct LineContent {
  int numbers = 0, words = 0;
};

LineContent ContentOfLine(std::string_view line) {
  LineContent content;
  for (const std::string_view part : SplitText(line, ',')) {
    for (const std::string_view word : SplitBlanks(Trim(part))) {
      if (Trim(word).empty()) continue;
      (ParseDouble(Trim(word)) ? content.numbers : content.words) += 1;
    }
  }
  return content;
}

/// A table below a header: lines with words, then two rows of as many numbers.
bool IsTableWithHeader(const std::vector<std::string_view>& lines) {
  constexpr int kMostHeaderLines = 8;  // as ParseJointTable passes over
  constexpr int kFewestNumbers = 3;
  int header = 0, first = 0;
  for (const std::string_view line : lines) {
    const LineContent content = ContentOfLine(line);
    if (content.numbers + content.words == 0) continue;
    if (content.words > 0 && first == 0) {
      if (++header > kMostHeaderLines) return false;
      continue;
    }
    if (content.words > 0 || content.numbers < kFewestNumbers) return false;
    if (first != 0) return header > 0 && content.numbers == first;
    first = content.numbers;
  }
  return false;
}

/// A table: only numbers in the first lines.
FileKind NumbersKind(std::string_view bytes) {
  std::string_view head = bytes.substr(0, 4096);
  if (head.size() < bytes.size()) {  // whole rows, or whole words of a row that is longer
    const std::size_t end = head.rfind('\n');
    head = head.substr(0, end != std::string_view::npos ? end : head.find_last_of(" \t\r,"));
  }
  const auto points = WithDecimalPoints(head, "");
  if (!points || *points) return FileKind::kNumbers;
  int numbers = 0;
  for (const std::string_view line : SplitText(head, '\n')) {
    for (const std::string_view part : SplitText(line, ',')) {
      for (const std::string_view word : SplitBlanks(Trim(part))) {
        if (Trim(word).empty()) continue;
        if (!ParseDouble(Trim(word))) return numbers >= 3 ? FileKind::kNumbers : FileKind::kUnknown;
        ++numbers;
      }
    }
  }
  return numbers >= 3 ? FileKind::kNumbers : FileKind::kUnknown;
}

/// "[]", "[{" or "[1": TOML has a name between brackets.
bool BeginsAsJsonList(std::string_view bytes) {
  const std::size_t inside = bytes.find_first_not_of("[ \t\r\n");
  const std::string_view line = Trim(bytes.substr(0, bytes.find('\n')));
  if (inside == std::string_view::npos) return false;
  if (line.back() == ']' && bytes.substr(0, kKindHead).find('=') != std::string_view::npos)
    return false;  // "[24265867]"
  const char c = bytes[inside];
  return c == ']' || c == '{' || c == '-' || (c >= '0' && c <= '9');
}

/// The keys of the top object, or of the objects of a top list, and of its first value.
class TopKeys : public nlohmann::json_sax<nlohmann::json> {
 public:
  std::set<std::string> top, below;
  bool keypoints = false;  ///< of OpenPose's people, anywhere
  bool list = false;       ///< the file is a list

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return ++depth_ > 0; }
  bool end_object() override { return --depth_ >= 0; }
  bool start_array(std::size_t) override {
    list = list || depth_ == 0;
    return ++depth_ > 0;
  }
  bool end_array() override { return --depth_ >= 0; }
  bool key(string_t& name) override {
    const int first = list ? 2 : 1;
    if (depth_ == first) top.insert(name);
    keypoints = keypoints || name == "pose_keypoints_2d";
    if (depth_ == first + 1 && top.size() == 1) below.insert(name);
    return top.size() < kMostKeys;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  int depth_ = 0;
};

bool IsVideo(std::string_view bytes) {
  if (StartsWith(bytes, "RIFF") && bytes.substr(std::min<std::size_t>(8, bytes.size()), 4) == "AVI ") return true;
  if (bytes.substr(std::min<std::size_t>(4, bytes.size()), 4) == "ftyp") return true;
  return StartsWith(bytes, "\x1A\x45\xDF\xA3") || StartsWith(bytes, std::string_view("\0\0\1\xBA", 4));
}

/// Text of two bytes a letter, which no reader takes: theirs says so.
bool IsWideBvh(std::string_view bytes) {
  if (!StartsWith(bytes, "\xFF\xFE") && !StartsWith(bytes, "\xFE\xFF")) return false;
  std::string text;
  for (const char c : bytes.substr(2, 64)) {
    if (c > ' ') text += c;
  }
  return StartsWith(text, "HIERARCHY");
}

/// The second byte of a C3D file is a P; a block of numbers has bytes of 0, which a text has not. A damaged PNG may
/// begin so too.
bool IsC3d(std::string_view bytes) {
  constexpr std::size_t kBlock = 512;
  return bytes.size() >= kBlock && bytes[1] == 'P' && static_cast<unsigned char>(bytes[0]) >= 2 &&
         bytes.substr(1, 3) != "PNG" && bytes.substr(0, kBlock).find('\0') != std::string_view::npos;
}

FileKind JsonKind(std::string_view bytes) {
  TopKeys keys;
  nlohmann::json::sax_parse(bytes.begin(), bytes.end(), &keys);
  const auto has = [&](const char* key) { return keys.top.count(key) > 0; };
  if (has("k4abt_sdk_version") || (has("joint_names") && has("bone_list"))) return FileKind::kAzureBodies;
  if (keys.list && (has("keypoints3d") || has("keypoints"))) return FileKind::kEasyMocap;
  if (has("people") || keys.keypoints) return FileKind::kOpenPose;
  if (has("bodies")) return FileKind::kPanopticBodies;
  if (has("views") && has("frames")) return FileKind::kDepthSequence;
  if (has("views") && has("depth_unit")) return FileKind::kDepthStill;
  if (keys.top.size() == 2 && has("content") && has("style")) return FileKind::kBandaiLabel;
  if (keys.below.count("babel_sid") > 0) return FileKind::kBabel;
  return keys.list ? FileKind::kJsonList : FileKind::kJson;
}

constexpr int kDeepest = 6;  // folders below the one that is asked for

}  // namespace

FileKind KindOf(std::string_view bytes) {
  if (StartsWith(bytes, "\x93NUMPY")) return FileKind::kNpy;
  if (StartsWith(bytes, "\x89PNG\r\n\x1a\n")) return FileKind::kPng;
  if (StartsWith(bytes, "\xFF\xD8\xFF")) return FileKind::kJpeg;
  if (IsVideo(bytes)) return FileKind::kVideo;
  if (StartsWith(bytes, "PK\x03\x04")) return FileKind::kZip;
  if (IsC3d(bytes)) return FileKind::kC3d;
  if (bytes.size() > 2 && bytes[0] == '\x80' && bytes[1] >= 2 && bytes[1] <= 5) return FileKind::kPickle;
  if (BeginsAsOldPickle(bytes.substr(0, kKindHead))) return FileKind::kPickle;
  if (IsWideBvh(bytes)) return FileKind::kBvh;
  bytes = WithoutByteOrderMark(bytes);
  const std::size_t first = bytes.find_first_not_of(" \t\r\n\f\v");
  if (first == std::string_view::npos) return FileKind::kEmpty;
  bytes.remove_prefix(first);
  if (SameWord(bytes.substr(0, std::string_view("HIERARCHY").size()), "HIERARCHY")) return FileKind::kBvh;
  if (StartsWith(bytes, "ply\n") || StartsWith(bytes, "ply\r")) return FileKind::kPly;
  if (StartsWith(bytes, "# .PCD") || StartsWith(bytes, "VERSION ")) return FileKind::kPcd;
  if (StartsWith(bytes, "%YAML:1.0")) return FileKind::kOpenCvStorage;
  if (SameWord(bytes.substr(0, std::string_view("PathFileType").size()), "PathFileType")) return FileKind::kTrc;
  if (bytes[0] == '{') return JsonKind(bytes);
  if (bytes[0] == '<')
    return bytes.find("<opencv_storage") == std::string_view::npos ? FileKind::kXml : FileKind::kOpenCvStorage;
  const std::vector<std::string_view> lines = LinesOf(bytes);
  if (const FileKind acclaim = AcclaimKind(lines); acclaim != FileKind::kUnknown) return acclaim;
  if (IsBareAmc(lines)) return FileKind::kAmc;
  if (bytes[0] == '[' && BeginsAsJsonList(bytes)) return JsonKind(bytes);
  if (bytes[0] == '[' && lines[0].back() == ']' && lines[0].find('"') == std::string_view::npos) return FileKind::kToml;
  // A storage whose first line is damaged: its reader says so.
  if (bytes.find("opencv-matrix") != std::string_view::npos) return FileKind::kOpenCvStorage;
  if (std::find(lines.begin(), lines.end(), "endheader") != lines.end()) return FileKind::kOpenSim;
  if (IsNtuSkeleton(lines)) return FileKind::kNtuSkeleton;
  if (IsTrajectory(lines)) return FileKind::kUnknown;
  return IsTableWithHeader(lines) ? FileKind::kNumbers : NumbersKind(bytes);
}

Expected<std::vector<FolderFile>> FilesToInspect(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) {
    const bool regular = std::filesystem::is_regular_file(path, error);
    return std::vector<FolderFile>{{DisplayPath(path.filename()), path, regular ? "" : "is no regular file"}};
  }
  Expected<FolderListing> listing = ListFiles(path, kDeepest, DeniedFolders::kSkip);
  if (!listing) return Forward(listing);
  return std::move(listing->files);
}

Expected<std::string> ReadHead(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return Fail(ErrorCode::kUnreadable, "the file cannot be opened", DisplayPath(path), "check its permissions");
  std::string head(kKindHead, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head;
}

bool EndsAsJpeg(const std::filesystem::path& path) {
  constexpr std::streamoff kTail = 4096;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  file.seekg(std::max<std::streamoff>(0, size - kTail));
  std::string tail(static_cast<std::size_t>(std::min(size, kTail)), '\0');
  file.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  return tail.find("\xFF\xD9") != std::string::npos;
}

}  // namespace mocurate
