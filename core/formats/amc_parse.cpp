#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "core/base/text.h"
#include "core/formats/amc.h"
#include "core/formats/file_rules.h"
#include "core/formats/line_reader.h"
#include "core/formats/number_scanner.h"

namespace mocurate {
namespace {

using Token = NumberScanner::Token;

constexpr std::size_t kFewPlaces = 10000;

class AmcParser {
 public:
  AmcParser(std::string_view bytes, const AmcOptions& options, const std::string& name)
      : scanner_(bytes, false), options_(options), name_(name), bytes_(bytes.size()) {
    if (options.skeleton == nullptr) return;
    Add("root", options.skeleton->root_order.size());
    for (const AsfBone& bone : options.skeleton->bones) {
      if (!bone.dof.empty()) Add(bone.name, bone.dof.size());
    }
  }

  Expected<Amc> Run() {
    for (bool more = true; more;) {
      line_ = scanner_.line();
      const Token token = scanner_.Next();
      const std::string_view text = scanner_.text();
      if (token == Token::kLineEnd) continue;
      if (token == Token::kEnd) break;
      Expected<bool> read = false;
      if (token == Token::kWord && text.front() == '#') {
        read = SkipLine();
      } else if (token == Token::kWord && text.front() == ':') {
        read = Keyword(std::string(text));
      } else if (token == Token::kNumber) {
        read = Frame();
      } else {
        read = Row(std::string(text));
      }
      if (!read) return Forward(read);
      more = *read;
    }
    if (amc_.frames == 0)
      return Fail(ErrorCode::kMalformed, "the file holds no frame", name_, "is it cut off? Copy it again");
    if (Status closed = CloseFrame(true); !closed) return Forward(closed);
    if (Status whole = LastFrame(); !whole) return Forward(whole);
    if (misread_ && 2 * amc_.damaged.size() > static_cast<std::size_t>(amc_.frames))
      return tl::unexpected<Error>(*std::move(misread_));
    if (Status missing = CheckMissingBones(frame_lines_, Reports(), name_, amc_); !missing) return Forward(missing);
    const auto fits = [this](std::size_t frames) { return CheckMemory(frames); };
    if (Status gaps = LeaveAmcGaps(name_, fits, amc_); !gaps) return Forward(gaps);
    return std::move(amc_);
  }

 private:
  tl::unexpected<Error> Bad(const std::string& what, const std::string& hint = "correct the line, or exclude the file",
                            int line = 0) const {
    const std::string frame =
        amc_.frames > 0 ? ", frame " + std::to_string(amc_.frame_numbers.back()) : std::string(", before any frame");
    return Fail(ErrorCode::kMalformed, what + frame, Place(line > 0 ? line : line_), hint);
  }

  std::string Place(int line) const { return name_ + ":" + std::to_string(line); }

  /// Null once the limit on findings is reached.
  Finding* Report(const char* code, const std::string& bone, double value, std::string message, int frame = -1) {
    const bool damage = std::string_view(code) != "frame_number" && frame < 0;
    if (damage && !Damaged()) amc_.damaged.push_back(amc_.frames - 1);
    if (amc_.findings.size() >= kMostAmcFindings) return nullptr;
    const int at = frame < 0 ? amc_.frames - 1 : frame;
    amc_.findings.push_back(FindingOfFrames(code, at, at + 1, value, std::move(message),
                                            damage ? FindingAction::kDropped : FindingAction::kKept));
    amc_.findings.back().joint = Shown(bone);
    return &amc_.findings.back();
  }

  /// The frame that is being read.
  bool Damaged() const { return !amc_.damaged.empty() && amc_.damaged.back() == amc_.frames - 1; }
  bool Reports() const { return options_.damaged_rows == DamagedRows::kReport; }

  std::size_t Add(const std::string& name, std::size_t channels) {
    const std::size_t bone = amc_.bones.size();
    index_.emplace(name, bone);
    amc_.bones.push_back({name, static_cast<int>(channels), amc_.channel_count});
    amc_.channel_count += static_cast<int>(channels);
    return bone;
  }

  /// Whether more than the end of the file follows.
  bool SkipLine() {
    Token token = scanner_.Next();
    while (token != Token::kLineEnd && token != Token::kEnd) token = scanner_.Next();
    return token == Token::kLineEnd;
  }

  Expected<bool> Keyword(const std::string& word) {
    const std::string_view key = std::string_view(word).substr(1);
    if (amc_.frames > 0) return Bad("'" + Shown(word) + "' follows the first frame; keywords come before it");
    if (SameWord(key, "asf-file") || SameWord(key, "asf-path")) return SkipLine();
    if (SameWord(key, "samples-per-second")) {
      const bool number = scanner_.Next() == Token::kNumber;
      if (!number || !(scanner_.value() >= 1e-6 && scanner_.value() <= 1e6)) {
        return Bad(":SAMPLES-PER-SECOND needs a rate from 1e-6 to 1e6",
                   "write the rate in Hz after it, or remove the line and declare ingest.source.rate");
      }
      amc_.hz = scanner_.value();
    } else if (SameWord(key, "degrees") || SameWord(key, "radians")) {
      const bool degrees = SameWord(key, "degrees");
      if (amc_.degrees && *amc_.degrees != degrees)
        return Bad("the file has both :DEGREES and :RADIANS", "remove the wrong one");
      amc_.degrees = degrees;
    } else if (!SameWord(key, "fully-specified")) {
      const auto nearest = Nearest(key, {"FULLY-SPECIFIED", "DEGREES", "RADIANS", "SAMPLES-PER-SECOND"});
      return Bad("unknown keyword '" + Shown(word) + "'",
                 nearest ? "did you mean ':" + *nearest + "'?" : "remove the line");
    }
    return LineEnds("'" + Shown(word) + "'");
  }

  Expected<bool> LineEnds(const std::string& behind) {
    const Token token = scanner_.Next();
    if (token == Token::kLineEnd || token == Token::kEnd) return token == Token::kLineEnd;
    return Bad("'" + Shown(scanner_.text()) + "' follows " + behind);
  }

  Expected<bool> Frame() {
    const double number = scanner_.value();
    const std::string text(scanner_.text());
    if (number != std::floor(number) || std::abs(number) > 1e9) {
      if (!FollowsWhole()) return Bad("'" + Shown(text) + "' is not a frame number");
      const bool more = SkipLine();
      if (Status begun = BeginUnnumbered("'" + Shown(text) + "' is found"); !begun) return Forward(begun);
      return more;
    }
    Expected<bool> more = LineEnds("frame number " + Shown(text));
    if (!more) return more;
    const int before = amc_.frames > 0 ? amc_.frame_numbers.back() : 0;
    // Began at a stray line before its number, which is this one.
    if (unnumbered_ && !HoldsBone() && number == before) return more;
    if (Status begun = Begin(static_cast<int>(number)); !begun) return Forward(begun);
    if (amc_.frames > 1 && number != before + 1.0) {
      Report("frame_number", "", number,
             Place(line_) + ": frame number " + Shown(text) + " follows " + std::to_string(before));
    }
    return more;
  }

  bool HoldsBone() const { return std::find(here_.begin(), here_.end(), 1) != here_.end(); }
  /// Whether the frame that is being read has ended, as the one before it did: what follows begins another.
  bool FollowsWhole() const {
    return Reports() && amc_.frames > 1 && last_ == last_before_ && here_[last_before_] != 0;
  }

  /// A frame whose number is damaged or missing has the one that is next.
  Status BeginUnnumbered(const std::string& what) {
    const int number = amc_.frame_numbers.back() + 1;
    const std::string place = Place(line_), expected = std::to_string(number);
    if (Status begun = Begin(number, true); !begun) return begun;
    Report("frame_number", "", number,
           place + ": " + what + " where frame number " + expected + " is expected: taken for that frame");
    return {};
  }

  /// A bone of the skeleton has a pose in every frame, with numbers or without.
  Status CheckMemory(std::size_t frames) const {
    const std::size_t bones = options_.skeleton == nullptr ? amc_.bones.size() : options_.skeleton->bones.size();
    return CheckPoseMemory(std::max(bones, static_cast<std::size_t>(amc_.channel_count) / 7), frames, bytes_, name_);
  }

  Status Begin(int number, bool unnumbered = false) {
    if (Status closed = CloseFrame(false); !closed) return closed;
    if (Status fits = CheckMemory(static_cast<std::size_t>(amc_.frames) + 1); !fits) return fits;
    if (amc_.frames == std::numeric_limits<int>::max() / 2) return Bad("too many frames");
    amc_.frame_numbers.push_back(number);
    ++amc_.frames;
    frame_lines_.push_back(line_);
    last_before_ = last_;
    unnumbered_ = unnumbered;
    misspelt_.reset();
    row_.assign(static_cast<std::size_t>(amc_.channel_count), 0.0);
    here_.assign(amc_.bones.size(), 0);
    return {};
  }

  /// A bone and its numbers.
  Expected<bool> Row(const std::string& bone) {
    if (amc_.frames == 0) return Bad("'" + Shown(bone) + "' is found where a frame number is expected");
    const std::string called = "bone '" + Shown(bone) + "'";
    numbers_.clear();
    const Token token = scanner_.Numbers(numbers_);
    const bool whole = token == Token::kLineEnd || token == Token::kEnd;
    const bool learns = options_.skeleton == nullptr && amc_.frames == 1;
    auto found = index_.find(bone);
    if (found == index_.end() && whole && numbers_.empty() && FollowsWhole()) {
      if (Status begun = BeginUnnumbered("'" + Shown(bone) + "' is found"); !begun) return Forward(begun);
      return token == Token::kLineEnd;
    }
    if (found == index_.end() && !learns) {
      const std::optional<std::size_t> meant = Meant(bone);
      const Error unknown = UnknownBone(called, meant);
      if (!Reports() || (amc_.frames == 1 && !meant)) return tl::unexpected<Error>(unknown);
      if (amc_.frames == 1 && !misread_) misread_ = unknown;
      if (meant && whole && numbers_.size() == static_cast<std::size_t>(amc_.bones[*meant].channels)) misspelt_ = meant;
      Report("bone_unknown", bone, static_cast<double>(numbers_.size()),
             Place(line_) + ": unknown " + called + " in frame " + std::to_string(amc_.frame_numbers.back()) +
                 (meant ? "; did you mean '" + amc_.bones[*meant].name + "'?" : ""));
      return whole ? token == Token::kLineEnd : SkipLine();
    }
    const bool comma = scanner_.text().find(',') != std::string_view::npos;
    if (!whole && comma && amc_.frames == 1) {
      return Bad("'" + Shown(scanner_.text()) + "' is not a finite number: " + called,
                 "numbers have a decimal point, not a comma: export the file again, or replace the commas");
    }
    if (!whole && (learns || !Reports())) {
      return Bad("'" + Shown(scanner_.text()) + "' is not a finite number: " + called + ", number " +
                 std::to_string(numbers_.size() + 1));
    }
    if (found == index_.end()) {
      if (numbers_.empty()) return Bad(called + " has no numbers");
      Add(bone, numbers_.size());
      row_.resize(static_cast<std::size_t>(amc_.channel_count), 0.0);
      here_.push_back(0);
      found = index_.find(bone);
    }
    const AmcBone& known = amc_.bones[found->second];
    if (found->second == first_ && here_[first_] != 0 && FollowsWhole()) {
      if (Status begun = BeginUnnumbered(called + " stands"); !begun) return Forward(begun);
    }
    if (amc_.frames == 1 && !HoldsBone()) first_ = found->second;
    last_ = found->second;
    if (here_[found->second] != 0) {
      if (!Reports() || amc_.frames < 2) return Bad(called + " appears twice");
      Report("bone_twice", bone, 2.0,
             Place(line_) + ": " + called + " appears twice in frame " + std::to_string(amc_.frame_numbers.back()));
      return whole ? token == Token::kLineEnd : SkipLine();
    }
    const auto large =
        std::find_if(numbers_.begin(), numbers_.end(), [](double number) { return std::abs(number) > kLargestNumber; });
    if (large != numbers_.end()) {
      const std::string what = called + " has " + FormatDouble(*large) + ", which is not a plausible value";
      if (learns || !Reports()) return Bad(what, "the row is damaged");
      Report("number_too_large", bone, static_cast<double>(large - numbers_.begin()), Place(line_) + ": " + what);
      return whole ? token == Token::kLineEnd : SkipLine();
    }
    const bool fits = whole && numbers_.size() == static_cast<std::size_t>(known.channels);
    if (!fits) {
      const std::string what = called + (whole ? " has " + std::to_string(numbers_.size()) + " numbers, not " +
                                                     std::to_string(known.channels)
                                               : " has '" + Shown(scanner_.text()) + "' for a number");
      if (!Reports()) return Bad(what, "the row is damaged, or cut off");
      Report("row_length", bone, static_cast<double>(numbers_.size()), Place(line_) + ": " + what);
      return whole ? token == Token::kLineEnd : SkipLine();
    }
    here_[found->second] = 1;
    std::copy(numbers_.begin(), numbers_.end(), row_.begin() + known.first_channel);
    return token == Token::kLineEnd;
  }

  /// The bone whose name is nearest to this one, of those that the frame does not have yet.
  std::optional<std::size_t> Meant(const std::string& bone) const {
    std::vector<std::string> missing;
    for (std::size_t b = 0; b < amc_.bones.size(); ++b) {
      if (here_[b] == 0) missing.push_back(amc_.bones[b].name);
    }
    const std::optional<std::string> nearest = Nearest(bone, missing);
    return nearest ? std::optional<std::size_t>(index_.at(*nearest)) : std::nullopt;
  }

  Error UnknownBone(const std::string& called, std::optional<std::size_t> meant) const {
    const std::string hint =
        meant ? "did you mean '" + amc_.bones[*meant].name + "'?"
        : options_.skeleton != nullptr
            ? "the skeleton has no bone of that name with dof: check that it is the skeleton of this motion"
            : "the first frame does not have it";
    return Bad("unknown " + called, hint).value();
  }

  /// `last`: of the file. A frame without a bone is damaged, or where the file was cut off.
  Status CloseFrame(bool last) {
    if (amc_.frames == 0) return {};
    if (!HoldsBone()) {
      if (!Reports() || amc_.frames < 2)
        return Bad("the frame holds no bone", "the file is cut off, or damaged: copy it again");
      if (!last && !Damaged()) {
        Report("bone_missing", "", static_cast<double>(amc_.bones.size()),
               Place(frame_lines_.back()) + ": frame " + std::to_string(amc_.frame_numbers.back()) + " holds no bone");
      }
    }
    // A number needs at least two bytes: a file with more values than bytes is missing most of what it declares.
    if (amc_.values.size() + row_.size() > bytes_ + kFewPlaces) {
      return Bad("most bones are missing in most frames", "is it the right skeleton?");
    }
    amc_.values.insert(amc_.values.end(), row_.begin(), row_.end());
    amc_.present.insert(amc_.present.end(), here_.begin(), here_.end());
    return {};
  }

  /// A last frame without the last bone of the frame before it marks a file that was cut off. It is dropped, because
  /// the rest of its last row may look complete.
  Status LastFrame() {
    const int last = amc_.frames - 1;
    if (last < 1 || here_[last_before_] != 0 || misspelt_ == last_before_) return {};
    int missing = 0;
    std::string first;
    for (std::size_t bone = 0; bone < amc_.bones.size(); ++bone) {
      const int b = static_cast<int>(bone);
      if (amc_.has(last, b) || !amc_.has(last - 1, b)) continue;
      if (++missing == 1) first = "'" + Shown(amc_.bones[bone].name) + "'";
    }
    if (missing == 0) return {};
    const std::string what_missing =
        "has no bone " + first + (missing > 1 ? " and " + Counted(missing - 1, "other") : "");
    if (!Reports()) return Bad("the last frame " + what_missing, "the file is cut off: copy it again");
    const std::string what = Place(line_) + ": the file is cut off within frame " +
                             std::to_string(amc_.frame_numbers.back()) + ", which begins at line " +
                             std::to_string(frame_lines_.back()) + " and " + what_missing;
    DropLast();
    if (Finding* finding = Report("cut_off", "", missing, what, last)) {
      finding->severity = Severity::kError;
      finding->action = FindingAction::kDropped;
    }
    return {};
  }

  /// Removes the last frame and its findings.
  void DropLast() {
    const int last = amc_.frames - 1;
    if (Damaged()) amc_.damaged.pop_back();
    while (!amc_.findings.empty() &&
           (amc_.findings.back().frame_begin == last || amc_.findings.size() >= kMostAmcFindings))
      amc_.findings.pop_back();
    amc_.values.resize(amc_.values.size() - row_.size());
    amc_.present.resize(amc_.present.size() - here_.size());
    amc_.frame_numbers.pop_back();
    frame_lines_.pop_back();
    --amc_.frames;
  }

  NumberScanner scanner_;
  const AmcOptions& options_;
  const std::string& name_;
  std::size_t bytes_;
  Amc amc_;
  std::unordered_map<std::string, std::size_t> index_;
  std::vector<double> numbers_, row_;
  std::vector<std::uint8_t> here_;
  std::vector<int> frame_lines_;            ///< (frames) of the frame numbers
  std::size_t first_ = 0;                   ///< bone with which frames begin
  std::size_t last_ = 0, last_before_ = 0;  ///< with which this frame and the one before it ended
  std::optional<std::size_t> misspelt_;     ///< bone of a complete row of this frame with an unknown name
  std::optional<Error> misread_;            ///< of the first frame, if most are as it
  bool unnumbered_ = false;                 ///< this frame began without its number
  int line_ = 1;
};

}  // namespace

Expected<Amc> ParseAmc(std::string_view bytes, const AmcOptions& options, const std::string& name) {
  return AmcParser(bytes, options, name).Run();
}

}  // namespace mocurate
