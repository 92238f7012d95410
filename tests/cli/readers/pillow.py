"""Images as Pillow decodes them: pillow.py FILE...; JSON, an object a file with mode, size and texels as hexadecimal digits."""

import json
import sys

from PIL import Image

described = []
for name in sys.argv[1:]:
    with Image.open(name) as image:
        image.load()
        described.append({"mode": image.mode, "size": image.size, "texels": image.tobytes().hex()})
print(json.dumps(described))
