# The install tree is one relocatable folder: bin/, lib/, share/tandem/.
set(CMAKE_INSTALL_RPATH "$ORIGIN/../lib")
