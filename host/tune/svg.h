// Plots with logarithmic axes as SVG inside a page of HTML.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace oclair::tune {

// For text and attributes of HTML and SVG. What is no UTF-8 or no printable character is replaced.
std::string escaped(const std::string& text);

// RFC 4648, section 4.
std::string base64(const std::string& bytes);

struct PlotPoint {
  double x, y;  // > 0
  std::string name;
  std::string color;
  bool filled;
};

struct PlotLine {
  std::vector<std::pair<double, double>> points;  // > 0
  std::string name;
  std::string color;
};

class Plot {
 public:
  Plot(std::string x_title, std::string y_title) : x_title_(std::move(x_title)), y_title_(std::move(y_title)) {}

  void add_point(PlotPoint point) { points_.push_back(std::move(point)); }
  void add_line(PlotLine line) { lines_.push_back(std::move(line)); }
  void add_level(double y, std::string name) { levels_.emplace_back(y, std::move(name)); }  // a horizontal line
  void note_y(double y, std::string name) { notes_.emplace_back(y, std::move(name)); }       // in place of the number on the axis

  std::string svg() const;

 private:
  std::string x_title_, y_title_;
  std::vector<PlotPoint> points_;
  std::vector<PlotLine> lines_;
  std::vector<std::pair<double, std::string>> levels_, notes_;
};

}  // namespace oclair::tune
