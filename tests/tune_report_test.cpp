// The page of HTML that tune writes.
#include "../host/tune/report.h"

#include <gtest/gtest.h>

#include <regex>

#include "../host/tune/svg.h"

using namespace oclair;
using namespace oclair::tune;

namespace {

Row row(const std::string& name, Effect effect, double gain) {
  Row r;
  r.name = name;
  r.effect = effect;
  r.estimates.speed = {1.5, 1.4, 1.6};
  r.estimates.variance = {0.5, 0.4, 0.6};
  r.estimates.bias = {-0.01, -0.02, -0.005};
  r.estimates.squared_bias = {1e-4, 0.5e-4, 2e-4};
  r.gain = {gain, 0.9 * gain, 1.1 * gain};
  r.difference = Picture(3 * 4 * 3, 0.25f);
  r.curve = {{1, 0.1, 0.4}, {2, 0.2, 0.3}};
  return r;
}

Result result() {
  Result r;
  r.scene = "a <b> & \"c\".xml";
  r.width = 4, r.height = 3;
  r.picture = Picture(3 * 4 * 3, 0.5f);
  r.curve = {{1, 0.1, 0.5}, {2, 0.2, 0.35}};
  r.rows = {row("fresnel=schlick", Effect::bias, 1.2), row("bvh-width=4", Effect::none, 0.9)};
  r.rows[1].estimates.same = true;
  r.recommended = 0;
  return r;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

}  // namespace

// The vectors of RFC 4648, section 10.
TEST(tune_report_test, base64_is_that_of_the_standard) {
  const std::pair<const char*, const char*> vectors[] = {{"", ""},         {"f", "Zg=="},         {"fo", "Zm8="},        {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="}, {"fooba", "Zm9vYmE="}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors) EXPECT_EQ(base64(bytes), text);
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(tune_report_test, what_a_file_is_called_is_no_markup) {
  const std::string page = report_of(result());
  EXPECT_EQ(page.find("a <b>"), std::string::npos);
  EXPECT_NE(page.find("a &lt;b&gt; &amp; &quot;c&quot;.xml"), std::string::npos);
}

TEST(tune_report_test, what_a_file_is_called_cannot_break_the_page) {
  Result r = result();
  r.scene = "a\xff\033[31m\nb.xml";
  const std::string page = report_of(r);
  EXPECT_NE(page.find("a\xef\xbf\xbd?[31m?b.xml"), std::string::npos);  // U+FFFD
  EXPECT_EQ(page.find('\033'), std::string::npos);
  EXPECT_EQ(page.find('\xff'), std::string::npos);
}

// On the plot are those that reach the error, and nothing is both sooner and less biased than a filled one.
TEST(tune_report_test, settings_that_never_reach_the_error_are_named_below_the_plot) {
  Result r = result();
  for (Row& shown : r.rows) shown.seconds = 1.0;
  EXPECT_EQ(report_of(r).find("Never there"), std::string::npos);
  r.rows[0].seconds.reset();
  r.rows[0].gain = {0, 0, 0};
  EXPECT_NE(report_of(r).find("Never there, since their bias alone is as large as the error: fresnel=schlick."), std::string::npos);
}

TEST(tune_report_test, the_page_needs_nothing_else) {
  const std::string page = report_of(result());
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("<link"), std::string::npos);
  EXPECT_EQ(count(page, "src=\""), count(page, "src=\"data:image/png;base64,"));
}

TEST(tune_report_test, every_setting_has_a_row_and_every_biased_one_a_picture) {
  const std::string page = report_of(result());
  EXPECT_EQ(count(page, "<tr"), 1u + 2u + 1u);      // head, rows, accurate
  EXPECT_EQ(count(page, "<tr class=\"best\">"), 1u);
  EXPECT_EQ(count(page, "<img "), 2u);              // the accurate picture, and one difference
  EXPECT_EQ(count(page, "<svg "), 2u);
  EXPECT_EQ(count(page, "<polyline "), 2u);
}

TEST(tune_report_test, tags_are_closed_in_their_order) {
  for (const std::string& page : {report_of(result()), report_of(Result{})}) {
    std::vector<std::string> open;
    const std::regex tag("<(/?)([a-z0-9]+)[^>]*?(/?)>");
    for (std::sregex_iterator it(page.begin(), page.end(), tag), end; it != end; ++it) {
      const std::string name = (*it)[2];
      if (name == "meta" || name == "img" || (*it)[3] == "/") continue;
      if ((*it)[1] == "") {
        open.push_back(name);
        continue;
      }
      ASSERT_FALSE(open.empty()) << name;
      EXPECT_EQ(open.back(), name);
      open.pop_back();
    }
    EXPECT_TRUE(open.empty());
  }
}

// A point's place is linear in the logarithm: 1, 10 and 100 lie at equal distances.
TEST(tune_report_test, axes_are_logarithmic) {
  Plot plot("x", "y");
  plot.add_line({{{1, 1}, {10, 10}, {100, 100}}, "line", "#000"});
  const std::string svg = plot.svg();
  const std::regex circle("<circle cx=\"([0-9.]+)\" cy=\"([0-9.]+)\"");
  std::vector<double> x, y;
  for (std::sregex_iterator it(svg.begin(), svg.end(), circle), end; it != end; ++it) x.push_back(std::stod((*it)[1])), y.push_back(std::stod((*it)[2]));
  ASSERT_EQ(x.size(), 3u);
  EXPECT_NEAR(x[1] - x[0], x[2] - x[1], 0.2);  // four digits are written
  EXPECT_NEAR(y[1] - y[0], y[2] - y[1], 0.2);
  EXPECT_GT(x[1], x[0] + 50.0);
  EXPECT_LT(y[1], y[0] - 50.0);
}

TEST(tune_report_test, a_plot_without_points_is_nothing) { EXPECT_EQ(Plot("x", "y").svg(), ""); }
