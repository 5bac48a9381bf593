#include "tandem/robot/urdf.h"
