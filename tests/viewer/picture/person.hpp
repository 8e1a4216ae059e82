#pragma once

#include <memory>
#include <string>

namespace palpate::test {

/// A separate program on the same screen that finds a window by its title and sends it the input of
/// a person.
class Person {
 public:
  /// Throws if there is no such window.
  Person(const std::string& screen, const std::string& title);
  ~Person();
  Person(const Person&) = delete;
  Person& operator=(const Person&) = delete;

  void closeWindow();
  /// Presses and releases a key, given by its X11 name: "q", "space", "F5".
  void press(const char* key);
  /// In pixels of the window, from the upper left.
  void pointAt(int x, int y);
  /// The left button, at the pointer.
  void holdButton();
  void letButtonGo();

 private:
  struct Impl;  // X11's headers define words like None
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::test
