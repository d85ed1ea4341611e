// Rows of equally spaced frames of motions.

#include "report/motion_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/charts.h"
#include "tests/report/browser.h"
#include "tests/report/builders.h"

namespace mocurate::test {
namespace {

using ::testing::HasSubstr;

Clip Named(const std::string& source, const std::string& label, int frames) {
  Clip clip;
  clip.identity.source = source;
  clip.identity.end_frame = frames;
  clip.label = label;
  clip.motion = Stepping(Walker(), frames);
  clip.rate = clip.motion->rate;
  return clip;
}

NamedMotions Set(const std::string& method) {
  NamedMotions set{method, {}};
  set.motions.skeleton = Walker();
  set.motions.labels = {"walk", "kick"};
  set.motions.clips = {Named(method + "/a", "kick", 30), Named(method + "/b", "walk", 40),
                       Named(method + "/c", "walk", 50)};
  return set;
}

std::vector<MotionRow> Chosen(const MotionPictureOptions& options) {
  const auto rows = ChooseMotionRows({Set("Real"), Set("Ours")}, options);
  EXPECT_TRUE(rows) << (rows ? "" : rows.error().Message());
  return rows ? *rows : std::vector<MotionRow>();
}

/// Least and largest coordinates of all lines and polygons.
Eigen::AlignedBox2d Bounds(const Drawing& drawing) {
  Eigen::AlignedBox2d box;
  for (const Shape& shape : drawing.shapes) {
    if (const auto* line = std::get_if<LineShape>(&shape)) {
      for (const Vector2d& point : line->points) box.extend(point);
    }
    if (const auto* polygon = std::get_if<PolygonShape>(&shape)) {
      for (const Vector2d& point : polygon->points) box.extend(point);
    }
  }
  return box;
}

TEST(MotionRows, WithoutLabelsOneMotionOfEachClassAndMethodIsShown) {
  const std::vector<MotionRow> rows = Chosen({});
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[0].label, "walk") << "in the order of the classes";
  EXPECT_EQ(rows[0].method, "Real");
  EXPECT_EQ(rows[1].method, "Ours");
  EXPECT_EQ(rows[2].label, "kick");
}

TEST(MotionRows, LabelsSamplesAndClipsChoose) {
  MotionPictureOptions options;
  options.labels = {"walk"};
  options.samples = 2;
  EXPECT_EQ(Chosen(options).size(), 4U);
  options.clips = {Set("Ours").motions.clips[0].id()};
  ASSERT_EQ(Chosen(options).size(), 1U);
  EXPECT_EQ(Chosen(options)[0].label, "kick");
  options = {};
  options.labels = {"wlak"};
  const auto unknown = ChooseMotionRows({Set("Real")}, options);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(unknown.error().where, "wlak");
  options = {};
  options.samples = 40;
  options.most_rows = 3;
  const auto many = ChooseMotionRows({Set("Real"), Set("Ours")}, options);
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().code, ErrorCode::kUsage);
}

TEST(MotionRows, EveryFigureLiesWithinThePicture) {
  for (const FigureChoice figure : {FigureChoice::kBones, FigureChoice::kCapsules}) {
    MotionPictureOptions options;
    options.figure = figure;
    options.title = "title";
    std::vector<MotionRow> rows = Chosen(options);
    rows[0].clips[0].segments = {{0.0, 0.7, "walk", "", ""}, {0.7, 1.3, "transition", "", ""}};
    const Drawing drawing = DrawMotionRows(rows, options);
    const Eigen::AlignedBox2d box = Bounds(drawing);
    EXPECT_GE(box.min().x(), 0.0);
    EXPECT_GE(box.min().y(), 0.0);
    EXPECT_LE(box.max().x(), drawing.width);
    EXPECT_LE(box.max().y(), drawing.height);
    EXPECT_EQ(ToSvg(drawing), ToSvg(DrawMotionRows(rows, options)));
    EXPECT_EQ(ToPng(drawing, 1.0), ToPng(drawing, 1.0));
  }
}

TEST(MotionRows, AVideoHoldsTheLastFrameOfWhatHasEnded) {
  const std::vector<MotionRow> rows = Chosen({});
  const MotionPictureOptions options;
  const auto at = [&](double seconds) { return ToSvg(DrawMotionGrid(rows, options, seconds)); };
  EXPECT_EQ(at(100.0), at(200.0));
  EXPECT_NE(at(0.0), at(0.3));
}

TEST(MotionRowsInABrowser, ThePictureIsRenderedAndFullOfFigures) {
  if (!HasBrowser()) GTEST_SKIP() << "chromium is missing";
  const ScratchFolder place;
  MotionPictureOptions options;
  options.figure = FigureChoice::kCapsules;
  const Drawing drawing = DrawMotionRows(Chosen(options), options);
  ASSERT_TRUE(WriteFile(place / "rows.svg", ToSvg(drawing)));
  // The page reports the share of the picture with ink, and ink on the edge.
  const std::string script =
      "<!doctype html><meta charset=utf-8><body><script>const i=new Image();i.onload=()=>{const "
      "c=document.createElement('canvas');c.width=i.width;c.height=i.height;const g=c.getContext('2d');g.drawImage(i,0,"
      "0);const d=g.getImageData(0,0,c.width,c.height).data;let n=0,e=0;for(let y=0;y<c.height;y++)for(let "
      "x=0;x<c.width;x++){const "
      "k=4*(y*c.width+x);if(d[k]+d[k+1]+d[k+2]<690){n++;if(x<2||y<2||x>c.width-3||y>c.height-3)"
      "e++;}}document.body.textContent='ink '+(n/c.width/c.height>0.02)+' edge '+e;};i.src='data:image/"
      "svg+xml;utf8,'+encodeURIComponent(document.getElementById('s').textContent);</script>";
  const std::string svg = ToSvg(drawing);
  const std::string page = "<script type=\"text/plain\" id=\"s\">" + svg + "</script>" + script;
  ASSERT_TRUE(WriteFile(place / "index.html", page));
  ASSERT_EQ(Browse(place, "--virtual-time-budget=3000 --dump-dom"), 0);
  EXPECT_THAT(ReadFile(place / "dom.html").value_or(""), HasSubstr("ink true edge 0"));
}

/// Texts of pictures that a browser draws beyond their edge, or over each other: their number.
int CutTexts(const std::vector<Drawing>& drawings) {
  const ScratchFolder place;
  std::string page = "<!doctype html><meta charset=utf-8><body>";
  for (const Drawing& drawing : drawings) page += ToSvg(drawing);
  page +=
      "<p id=cut></p><script>let cut=0,all=0;for(const s of document.querySelectorAll('svg')){const "
      "[,,W,H]=s.getAttribute('viewBox').split(' ').map(Number),boxes=[...s.querySelectorAll('text')].map(t=>t.getBBox"
      "());all+=boxes.length;boxes.forEach((a,i)=>{if(a.x<0||a.y<0||a.x+a.width>W||a.y+a.height>H)cut++;boxes.slice(i+"
      "1)"
      ".forEach(b=>{if(Math.min(a.x+a.width,b.x+b.width)-Math.max(a.x,b.x)>1&&Math.min(a.y+a.height,b.y+b.height)-Math."
      "max(a.y,b.y)>4)cut++;});});}document.getElementById('cut').textContent='cut '+(all>20?cut:99)+'.';</script>";
  EXPECT_TRUE(WriteFile(place / "index.html", page));
  EXPECT_EQ(Browse(place, "--virtual-time-budget=3000 --dump-dom"), 0);
  const std::string document = ReadFile(place / "dom.html").value_or("");
  const std::size_t at = document.find("cut \"") == std::string::npos ? document.find("<p id=\"cut\">cut ") : 0;
  return at == std::string::npos ? -1 : std::atoi(document.c_str() + at + std::string("<p id=\"cut\">cut ").size());
}

TEST(MotionRowsInABrowser, NoTextIsCutOrCoversAnother) {
  if (!HasBrowser()) GTEST_SKIP() << "chromium is missing";
  MotionPictureOptions plain;
  plain.title = "a title that is much longer than the picture is wide, so that it continues in a second line below";
  plain.corner = "profile smoke; a set with a long name: stand-in by the studio";
  plain.words = {{"walk", "walking up and down the long corridor"}};
  plain.absent = {{"a method without code", "no code in this project"}};
  std::vector<MotionRow> rows = Chosen(plain);
  rows[0].method = "Ours, all bones of skeleton B x 1.25, after 10,000 iterations";
  for (MotionRow& row : rows) {
    if (!row.clips.empty())
      row.clips[0].segments = {
          {0.0, 0.3, "walk", "", "recorded"}, {0.3, 0.6, "transition", "", ""}, {0.6, 1.0, "sit down", "", ""}};
  }
  Plot plot{"accuracy and FID", "frames", "accuracy", {}, "FID_test", std::array<double, 2>{60.0, 60.0}};
  plot.curves = {{"recorded and generated motions", {{40.0, 1234567.0, 1e5, 2e6}, {120.0, -3.0}}},
                 {"ACTOR + SSMCT (w. align)", {{40.0, 0.001}, {120.0, 0.002}}, -1, true}};
  BarChart bars{"shares", {{"Ours w/o Lie", {{0.3, kBlue, "rank 1"}, {0.7, kRed, "rank 2"}}, "64 % in the first two"}}};
  bars.full = 1.0;
  bars.legend = bars.rows[0].parts;
  bars.note = "20 participants. Whiskers: 95 % (Wilson), assuming independent votes.";
  std::vector<MotionRow> themes = rows;
  for (MotionRow& row : themes) row.theme = row.clips.empty() ? "" : "squat, jump and jumping squat";
  EXPECT_EQ(CutTexts({DrawMotionRows(rows, plain), DrawMotionRows(themes, plain),
                      PlotSheet{plain.title, plain.title, plain.corner, {plot, plot, plot}, 2}.Draw(), bars.Draw()}),
            0);
}

TEST(Plots, CurvesMarksAndBandsLieWithinThePicture) {
  PlotSheet sheet{"a title of many words, as long as the one of a picture that says where its data are from",
                  "",
                  "profile smoke",
                  {}};
  Plot plot{"FID", "step", "", {}, "accuracy", std::array<double, 2>{1.0, 5.0}};
  plot.curves = {{"Ours", {{1.0, 2.0, 1.5, 9.0}, {20.0, -3.0}}}, {"Theirs", {{3.0, 0.5}}, -1, true}};
  sheet.plots = {plot};
  const Drawing drawing = sheet.Draw();
  const Eigen::AlignedBox2d box = Bounds(drawing);
  EXPECT_GE(box.min().minCoeff(), 0.0);
  EXPECT_LE(box.max().x(), drawing.width);
  EXPECT_LE(box.max().y(), drawing.height);
  for (const char* text : {"Ours", "Theirs", "profile smoke", "stroke-dasharray"}) {
    EXPECT_THAT(ToSvg(drawing), HasSubstr(text));
  }
  EXPECT_EQ(sheet.Json()["plots"][0]["curves"][0]["points"][0]["high"], 9.0);
}

}  // namespace
}  // namespace mocurate::test
