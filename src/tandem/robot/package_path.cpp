#include "tandem/robot/package_path.h"
