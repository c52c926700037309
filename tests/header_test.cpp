#include "../host/header.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "../host/error.h"

namespace {

using namespace oclair;

using Value = ImageAttributes::value_type::second_type;

std::map<std::string, Value> by_name(const ImageAttributes& attributes) {
  std::map<std::string, Value> result;
  for (const auto& [name, value] : attributes) EXPECT_TRUE(result.emplace(name, value).second) << name << " is there twice";
  return result;
}

HeaderTexts texts(const std::string& command_line) {
  Scene scene;
  scene.settings.seed = 18446744073709551615u;
  scene.settings.sampler = SAMPLER_SOBOL;
  scene.features = FEATURE_DIFFUSE | FEATURE_OREN_NAYAR_FAST;
  scene.approximations = APPROXIMATION_SCHLICK;
  scene.double_precision = true;
  Device device;
  device.name = "a device";
  device.platform = "a platform 1.2";
  return header_texts({"a.xml", "0123abcd", command_line, "--spp 64"}, scene, device);
}

Figures figures(double seconds) {
  Figures f;
  f.ranges = {{0, 48}, {64, 16}};
  f.rejected = 3;
  f.rays = 8589934592;
  f.estimated_error = 0.25;
  f.stopped = "spp";
  f.seconds = {{"parse", seconds}, {"passes", 2 * seconds}};
  return f;
}

// While it lives SOURCE_DATE_EPOCH has that value.
class SourceDate {
 public:
  explicit SourceDate(const char* value) { setenv("SOURCE_DATE_EPOCH", value, 1); }
  ~SourceDate() { unsetenv("SOURCE_DATE_EPOCH"); }
};

}  // namespace

TEST(header_test, every_fact_has_its_attribute) {
  const std::map<std::string, Value> expected = {{"software", "oclair " OCLAIR_VERSION},
                                                 {"scene", "a.xml"},
                                                 {"sceneHash", "0123abcd"},
                                                 {"commandLine", "oclair render a.xml"},
                                                 {"options", "--spp 64"},
                                                 {"seed", "18446744073709551615"},
                                                 {"sampler", "sobol"},
                                                 {"features", "DIFFUSE OREN_NAYAR_FAST"},
                                                 {"approximations", "fresnel=schlick oren_nayar=qualitative"},
                                                 {"arithmetic", "double"},
                                                 {"device", "a device"},
                                                 {"driver", "a platform 1.2"},
                                                 {"sampleRanges", "0:48 64:16"},
                                                 {"samplesPerPixel", "64"},
                                                 {"rejectedSamples", "3"},
                                                 {"rays", "8589934592"},
                                                 {"estimatedError", 0.25f},
                                                 {"stopped", "spp"},
                                                 {"secondsPerPhase", "parse 1.500, passes 3.000"}};
  EXPECT_EQ(by_name(header_attributes(texts("oclair render a.xml"), figures(1.5), std::nullopt)), expected);
}

TEST(header_test, what_is_not_known_is_not_said) {
  const auto attributes = by_name(header_attributes({{"scene", "a.xml"}, {"sceneHash", ""}}, Figures{}, std::nullopt));
  for (const char* absent : {"sceneHash", "rays", "estimatedError", "stopped", "secondsPerPhase", "capDate", "utcOffset"})
    EXPECT_FALSE(attributes.count(absent)) << absent;
  EXPECT_TRUE(attributes.count("scene"));
}

TEST(header_test, with_a_date_nothing_is_said_that_differs_between_equal_runs) {
  const auto attributes = [](const char* line, double seconds, std::optional<std::int64_t> date) {
    return header_attributes(texts(line), figures(seconds), date);
  };
  EXPECT_EQ(attributes("oclair render -o a.exr", 1.0, 0), attributes("oclair render -o b.exr", 2.0, 0));
  EXPECT_NE(attributes("oclair render -o a.exr", 1.0, {}), attributes("oclair render -o b.exr", 1.0, {}));
  Figures merged = figures(1.0);
  merged.stopped = "";
  EXPECT_EQ(header_attributes(texts("oclair merge"), merged, 0), attributes("oclair render", 1.0, 0));
  EXPECT_NE(header_attributes(texts("oclair render"), merged, {}), attributes("oclair render", 1.0, {}));
  EXPECT_NE(attributes("oclair render -o a.exr", 1.0, {}), attributes("oclair render -o a.exr", 2.0, {}));
}

// `date -u -d @1700000000`
TEST(header_test, the_date_has_the_format_of_the_standard_attribute) {
  const auto date_of = [](std::int64_t date) {
    const auto attributes = by_name(header_attributes({}, {}, date));
    EXPECT_EQ(attributes.at("utcOffset"), Value{0.0f});
    return std::get<std::string>(attributes.at("capDate"));
  };
  EXPECT_EQ(date_of(0), "1970:01:01 00:00:00");
  EXPECT_EQ(date_of(1700000000), "2023:11:14 22:13:20");
  EXPECT_EQ(date_of(253402300799), "9999:12:31 23:59:59");
}

TEST(header_test, the_date_is_that_of_the_environment_or_none) {
  unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_EQ(reproducible_date(), std::nullopt);
  EXPECT_EQ((SourceDate("1700000000"), reproducible_date()), 1700000000);
  for (const char* wrong : {"", "now", "-1", "1.5", "1700000000 ", "253402300800", "99999999999999999999"}) {
    const SourceDate date(wrong);
    try {
      reproducible_date();
      ADD_FAILURE() << wrong;
    } catch (const Error& error) {
      EXPECT_EQ(error.exit, Exit::usage);
      EXPECT_EQ(
          std::string(error.what()).find("SOURCE_DATE_EPOCH '" + std::string(wrong) + "': expected seconds since 1970"), 0u);
    }
  }
}

TEST(header_test, the_command_line_is_that_of_the_process) {
  EXPECT_EQ(command_line().find(testing::internal::GetArgvs()[0]), 0u) << command_line();
}
